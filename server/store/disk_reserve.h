#ifndef FASCICLE_SERVER_STORE_DISK_RESERVE_H_
#define FASCICLE_SERVER_STORE_DISK_RESERVE_H_

#include <cstdint>
#include <mutex>
#include <string>

namespace fascicle::server {

// Keeps a part of the disk for what must always be possible: deleting jobs, storing how jobs end, and starting the
// server. Thread-safe.
class DiskReserve {
 public:
  // `least_free`: free space below which the disk counts as full [byte]; negative: a fiftieth of the disk, within 4 MiB
  // and 1 GiB. The file DIRECTORY/reserve occupies a quarter of that, at most 16 MiB.
  DiskReserve(const std::string& directory, std::int64_t least_free);

  // Whether there is room for more than the above. Takes the reserve back when there is enough.
  bool HasRoom();
  // Gives the reserve to other files.
  void Release();
  std::int64_t free_bytes() const;  // for users other than root
  std::int64_t least_free() const { return least_free_; }

 private:
  const std::string directory_, path_;
  const std::int64_t least_free_;
  const std::int64_t size_;
  std::mutex mutex_;
  bool is_kept_ = false;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_DISK_RESERVE_H_
