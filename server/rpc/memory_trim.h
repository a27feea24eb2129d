#ifndef FASCICLE_SERVER_RPC_MEMORY_TRIM_H_
#define FASCICLE_SERVER_RPC_MEMORY_TRIM_H_

#include <cstdint>

namespace fascicle::server {

// Returns freed memory of the process to the machine when it has become much: the allocator keeps it otherwise, after a
// burst of calls or the end of a large job. Not thread-safe.
class MemoryTrim {
 public:
  // Call every second. Takes some milliseconds at most every 5 s.
  void Look();

 private:
  std::int64_t least_ = 0;  // resident memory when it was least [byte]
  int rest_ = 0;            // calls to skip
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_MEMORY_TRIM_H_
