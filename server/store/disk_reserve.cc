#include "server/store/disk_reserve.h"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>

namespace fascicle::server {
namespace {

constexpr std::int64_t kMiB = 1 << 20;

struct Space {
  std::int64_t size = 0;  // of the filesystem [byte]
  std::int64_t free = 0;  // [byte]
};

// Unlimited where it can't be found out: a write will tell.
Space SpaceOf(const std::string& directory) {
  struct statvfs information;
  if (statvfs(directory.c_str(), &information) != 0) return {INT64_MAX, INT64_MAX};
  const auto block = static_cast<std::int64_t>(information.f_frsize);
  return {static_cast<std::int64_t>(information.f_blocks) * block,
          static_cast<std::int64_t>(information.f_bavail) * block};
}

std::int64_t LeastFree(const std::string& directory, std::int64_t wanted) {
  return wanted >= 0 ? wanted : std::clamp(SpaceOf(directory).size / 50, 4 * kMiB, 1024 * kMiB);
}

bool Occupy(const std::string& path, std::int64_t size) {
  const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0) return false;
  const bool occupied = posix_fallocate(descriptor, 0, size) == 0;
  close(descriptor);
  if (!occupied) unlink(path.c_str());
  return occupied;
}

}  // namespace

DiskReserve::DiskReserve(const std::string& directory, std::int64_t least_free)
    : directory_(directory),
      path_(directory + "/reserve"),
      least_free_(LeastFree(directory, least_free)),
      size_(std::min(least_free_ / 4, 16 * kMiB)),
      is_kept_(access(path_.c_str(), F_OK) == 0) {
  if (!HasRoom()) Release();
}

std::int64_t DiskReserve::free_bytes() const { return SpaceOf(directory_).free; }

bool DiskReserve::HasRoom() {
  if (free_bytes() < least_free_) return false;
  const std::lock_guard lock(mutex_);
  if (!is_kept_ && size_ > 0) is_kept_ = Occupy(path_, size_);
  return true;
}

void DiskReserve::Release() {
  const std::lock_guard lock(mutex_);
  unlink(path_.c_str());
  is_kept_ = false;
}

}  // namespace fascicle::server
