#ifndef FASCICLE_CLIENT_LIB_WATCH_H_
#define FASCICLE_CLIENT_LIB_WATCH_H_

#include <stop_token>
#include <string>

#include "client/lib/client.h"
#include "client/lib/connection.h"

namespace fascicle::client {

// Client::Watch.
Result<v1::Job> WatchJob(Connection& connection, const std::string& name, const WatchOptions& options,
                         const WatchEvents& events, const std::stop_token& stop);

// Client::GetGeometry.
Result<v1::Geometry> FetchGeometry(Connection& connection, const std::string& name, const std::stop_token& stop);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_WATCH_H_
