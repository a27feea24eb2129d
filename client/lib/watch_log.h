#ifndef FASCICLE_CLIENT_LIB_WATCH_LOG_H_
#define FASCICLE_CLIENT_LIB_WATCH_LOG_H_

#include <functional>
#include <stop_token>
#include <string>

#include "client/lib/client.h"
#include "client/lib/connection.h"

namespace fascicle::client {

// Client::WatchLog.
Result<v1::Job> WatchLog(Connection& connection, const std::string& name, const LogOptions& options,
                         const std::function<void(const v1::LogLine&)>& on_line, const std::stop_token& stop);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_WATCH_LOG_H_
