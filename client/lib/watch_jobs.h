#ifndef FASCICLE_CLIENT_LIB_WATCH_JOBS_H_
#define FASCICLE_CLIENT_LIB_WATCH_JOBS_H_

#include <stop_token>

#include "client/lib/client.h"
#include "client/lib/connection.h"

namespace fascicle::client {

// See Client::WatchJobs.
Error WatchAllJobs(Connection& connection, const JobsWatch& watch, const std::stop_token& stop);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_WATCH_JOBS_H_
