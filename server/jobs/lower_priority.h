#ifndef FASCICLE_SERVER_JOBS_LOWER_PRIORITY_H_
#define FASCICLE_SERVER_JOBS_LOWER_PRIORITY_H_

#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>

namespace fascicle::server {

// Makes the calling thread, and threads that it starts, yield to others of this machine: `steps` of niceness more.
// On Linux each thread has its own. Does nothing where that is not possible.
inline void LowerPriority(int steps) {
  if (steps <= 0) return;
  const auto self = static_cast<id_t>(gettid());
  errno = 0;
  const int now = getpriority(PRIO_PROCESS, self);
  if (errno == 0) setpriority(PRIO_PROCESS, self, now + steps);
}

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_LOWER_PRIORITY_H_
