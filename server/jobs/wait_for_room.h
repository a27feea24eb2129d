#ifndef FASCICLE_SERVER_JOBS_WAIT_FOR_ROOM_H_
#define FASCICLE_SERVER_JOBS_WAIT_FOR_ROOM_H_

#include <chrono>
#include <string>
#include <thread>

#include "core/base/stop.h"
#include "server/jobs/active_job.h"
#include "server/store/store.h"

namespace fascicle::server {

// Calls `write` when the store has room for it, and again when the disk was full after all. Meanwhile the job says why
// it waits. Throws Stopped if the job is asked to stop, and whatever else `write` throws.
template <class Write>
void WriteWhenRoom(Store& store, ActiveJob& job, const Write& write) {
  constexpr std::chrono::milliseconds kInterval(200);
  while (true) {
    std::string problem = store.Problem();
    if (problem.empty()) {
      try {
        write();
        job.SetWaiting("");
        return;
      } catch (const NoSpaceError& error) {
        problem = error.what();
      }
    }
    job.SetWaiting(problem);
    ThrowIfStopped(job.stop_token());
    std::this_thread::sleep_for(kInterval);
  }
}

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_WAIT_FOR_ROOM_H_
