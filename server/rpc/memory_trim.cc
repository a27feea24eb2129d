#include "server/rpc/memory_trim.h"

#include <malloc.h>
#include <unistd.h>

#include <fstream>

namespace fascicle::server {
namespace {

// Resident memory of this process [byte]; 0 if unknown.
std::int64_t Resident() {
  std::ifstream file("/proc/self/statm");
  std::int64_t all = 0, resident = 0;
  file >> all >> resident;
  return file ? resident * sysconf(_SC_PAGESIZE) : 0;
}

}  // namespace

void MemoryTrim::Look() {
  constexpr std::int64_t kMuch = 32 << 20;
  constexpr int kRest = 5;
  if (rest_ > 0) {
    --rest_;
    return;
  }
  const std::int64_t resident = Resident();
  if (least_ == 0 || resident < least_) least_ = resident;
  if (resident < least_ + kMuch) return;
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  rest_ = kRest;
}

}  // namespace fascicle::server
