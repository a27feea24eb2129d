#include "server/store/file_system.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "server/store/store.h"

namespace fascicle::server {
namespace {

[[noreturn]] void Throw(const std::string& path, const char* doing) {
  const std::string what = path + ": " + std::strerror(errno) + " (" + doing + ")";
  if (errno == ENOSPC || errno == EDQUOT) throw NoSpaceError(what);
  throw StoreError(what);
}

int Open(const std::string& path, int flags) {
  const int descriptor = open(path.c_str(), flags | O_CLOEXEC, 0600);
  if (descriptor < 0) Throw(path, "open");
  return descriptor;
}

void Sync(const std::string& path, int flags) {
  const int descriptor = Open(path, flags);
  const int result = fsync(descriptor);
  const int error = errno;
  close(descriptor);
  errno = error;
  if (result != 0) Throw(path, "fsync");
}

}  // namespace

void SyncFile(const std::string& path) { Sync(path, O_RDONLY); }

void SyncParent(const std::string& path) {
  const std::string parent = std::filesystem::path(path).parent_path().string();
  Sync(parent.empty() ? "." : parent, O_RDONLY | O_DIRECTORY);
}

FileWriter::FileWriter(const std::string& path) : path_(path), descriptor_(Open(path, O_WRONLY | O_CREAT | O_TRUNC)) {}

FileWriter::~FileWriter() {
  if (descriptor_ >= 0) close(descriptor_);
}

void FileWriter::Write(const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t written = write(descriptor_, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) Throw(path_, "write");
    bytes += written;
    size -= static_cast<std::size_t>(written);
  }
}

void FileWriter::Finish() {
  if (fsync(descriptor_) != 0) Throw(path_, "fsync");
  if (close(std::exchange(descriptor_, -1)) != 0) Throw(path_, "close");
}

DirectoryLock::DirectoryLock(const std::string& directory)
    : path_(directory + "/lock"), descriptor_(Open(path_, O_RDWR | O_CREAT)) {
  if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  const int error = errno;
  close(descriptor_);
  errno = error;
  if (error == EWOULDBLOCK) throw StoreError(directory + ": is in use by another server");
  Throw(path_, "flock");
}

bool DirectoryLock::IsThere() const {
  struct stat own, named;
  return fstat(descriptor_, &own) == 0 && stat(path_.c_str(), &named) == 0 && own.st_ino == named.st_ino &&
         own.st_dev == named.st_dev;
}

DirectoryLock::~DirectoryLock() { close(descriptor_); }

bool IsNetworkFilesystem(std::uint64_t statfs_type) {
  static constexpr std::array<std::uint64_t, 14> kTypes = {
      0x6969,      // NFS
      0x517B,      // SMB
      0xFF534D42,  // CIFS
      0xFE534D42,  // SMB 2
      0x564C,      // NCP
      0x01021997,  // 9p: locks and durability depend on the host behind it
      0x65735546,  // FUSE: sshfs, s3fs, virtiofs and the like; a local one cannot be told apart
      0x00C36400,  // Ceph
      0x5346414F,  // AFS
      0x6B414653,  // AFS of the kernel
      0x73757245,  // Coda
      0x0BD00BD0,  // Lustre
      0x47504653,  // GPFS
      0x19830326,  // BeeGFS
  };
  return std::find(kTypes.begin(), kTypes.end(), statfs_type & 0xFFFFFFFF) != kTypes.end();
}

void CheckLocal(const std::string& directory) {
  struct statfs information;
  if (statfs(directory.c_str(), &information) != 0) Throw(directory, "statfs");
  if (IsNetworkFilesystem(static_cast<std::uint64_t>(information.f_type))) {
    throw StoreError(directory + ": is on a network filesystem, where a database is not safe; choose a local disk");
  }
}

}  // namespace fascicle::server
