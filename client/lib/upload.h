#ifndef FASCICLE_CLIENT_LIB_UPLOAD_H_
#define FASCICLE_CLIENT_LIB_UPLOAD_H_

#include <stop_token>
#include <vector>

#include <grpcpp/support/status.h>

#include "client/lib/client.h"
#include "client/lib/connection.h"

namespace fascicle::client {

// Uploads those of `assets` that the server lacks. CANCELLED after a stop request.
grpc::Status UploadMissing(Connection& connection, const std::vector<AssetFile>& assets, const std::stop_token& stop);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_UPLOAD_H_
