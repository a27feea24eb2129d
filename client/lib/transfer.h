#ifndef FASCICLE_CLIENT_LIB_TRANSFER_H_
#define FASCICLE_CLIENT_LIB_TRANSFER_H_

#include <optional>
#include <stop_token>
#include <string>

#include "client/lib/client.h"
#include "client/lib/connection.h"

namespace fascicle::client {

// Client::ExportJob.
std::optional<Error> DownloadJob(Connection& connection, const std::string& name, const std::string& path,
                                 const std::stop_token& stop);

// Client::ImportJob. `request_id` identifies the import, which is repeated after a lost connection.
Result<v1::Job> UploadJob(Connection& connection, const std::string& path, bool new_name, const std::string& request_id,
                          const std::stop_token& stop);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_TRANSFER_H_
