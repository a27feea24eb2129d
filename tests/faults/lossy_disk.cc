#include "lossy_disk.h"

#include <sqlite3.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <random>
#include <vector>

namespace fascicle::server {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSector = 512;

// A write, or the end of a file that was cut off (without new bytes), that no sync has followed.
struct Unsynced {
  sqlite3_int64 at = 0;
  sqlite3_int64 size_before = 0;
  std::string before, after;
  bool is_truncation = false;
};

struct Disk {
  Syncs syncs = Syncs::kHonoured;
  sqlite3_vfs* real = nullptr;
  std::mutex mutex;  // held for ever once the power is off
  std::map<std::string, std::vector<Unsynced>> files;
};

Disk& TheDisk() {
  static auto* disk = new Disk;
  return *disk;
}

struct File {
  sqlite3_file base;
  std::string* path;
  sqlite3_file* real;
};

File& Of(sqlite3_file* file) { return *reinterpret_cast<File*>(file); }
sqlite3_file* RealOf(sqlite3_file* file) { return Of(file).real; }

// The bytes of a file from `at`, at most `count`, before it changes.
std::string Read(sqlite3_file* real, sqlite3_int64 at, sqlite3_int64 count) {
  sqlite3_int64 size = 0;
  real->pMethods->xFileSize(real, &size);
  std::string bytes(static_cast<std::size_t>(std::clamp<sqlite3_int64>(size - at, 0, count)), '\0');
  if (!bytes.empty()) real->pMethods->xRead(real, bytes.data(), static_cast<int>(bytes.size()), at);
  return bytes;
}

sqlite3_int64 SizeOf(sqlite3_file* real) {
  sqlite3_int64 size = 0;
  real->pMethods->xFileSize(real, &size);
  return size;
}

int Close(sqlite3_file* file) {
  const int code = RealOf(file)->pMethods->xClose(RealOf(file));
  delete Of(file).path;
  return code;
}
int ReadFile(sqlite3_file* file, void* to, int count, sqlite3_int64 at) {
  return RealOf(file)->pMethods->xRead(RealOf(file), to, count, at);
}
int Write(sqlite3_file* file, const void* from, int count, sqlite3_int64 at) {
  const std::lock_guard lock(TheDisk().mutex);
  sqlite3_file* real = RealOf(file);
  Unsynced write = {at, SizeOf(real), Read(real, at, count), std::string(static_cast<const char*>(from), count)};
  TheDisk().files[*Of(file).path].push_back(std::move(write));
  return real->pMethods->xWrite(real, from, count, at);
}
int Truncate(sqlite3_file* file, sqlite3_int64 size) {
  const std::lock_guard lock(TheDisk().mutex);
  sqlite3_file* real = RealOf(file);
  const sqlite3_int64 before = SizeOf(real);
  TheDisk().files[*Of(file).path].push_back({size, before, Read(real, size, before - size), "", true});
  return real->pMethods->xTruncate(real, size);
}
int Sync(sqlite3_file* file, int flags) {
  const std::lock_guard lock(TheDisk().mutex);
  if (TheDisk().syncs == Syncs::kHonoured) TheDisk().files[*Of(file).path].clear();
  return RealOf(file)->pMethods->xSync(RealOf(file), flags);
}
int FileSize(sqlite3_file* file, sqlite3_int64* size) { return RealOf(file)->pMethods->xFileSize(RealOf(file), size); }
int Lock(sqlite3_file* file, int kind) { return RealOf(file)->pMethods->xLock(RealOf(file), kind); }
int Unlock(sqlite3_file* file, int kind) { return RealOf(file)->pMethods->xUnlock(RealOf(file), kind); }
int CheckReserved(sqlite3_file* file, int* out) {
  return RealOf(file)->pMethods->xCheckReservedLock(RealOf(file), out);
}
int FileControl(sqlite3_file* file, int operation, void* argument) {
  return RealOf(file)->pMethods->xFileControl(RealOf(file), operation, argument);
}
int SectorSize(sqlite3_file* file) { return RealOf(file)->pMethods->xSectorSize(RealOf(file)); }
int Characteristics(sqlite3_file*) { return 0; }  // promises nothing
int ShmMap(sqlite3_file* file, int page, int size, int extend, void volatile** out) {
  return RealOf(file)->pMethods->xShmMap(RealOf(file), page, size, extend, out);
}
int ShmLock(sqlite3_file* file, int offset, int n, int flags) {
  return RealOf(file)->pMethods->xShmLock(RealOf(file), offset, n, flags);
}
void ShmBarrier(sqlite3_file* file) { RealOf(file)->pMethods->xShmBarrier(RealOf(file)); }
int ShmUnmap(sqlite3_file* file, int remove) { return RealOf(file)->pMethods->xShmUnmap(RealOf(file), remove); }

const sqlite3_io_methods kMethods = {
    2,           Close,      ReadFile,        Write,  Truncate, Sync,       FileSize, Lock,    Unlock, CheckReserved,
    FileControl, SectorSize, Characteristics, ShmMap, ShmLock,  ShmBarrier, ShmUnmap, nullptr, nullptr};

int Open(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* out_flags) {
  File& own = Of(file);
  own.real = reinterpret_cast<sqlite3_file*>(reinterpret_cast<char*>(file) + sizeof(File));
  own.base.pMethods = nullptr;
  const int code = TheDisk().real->xOpen(TheDisk().real, name, own.real, flags, out_flags);
  if (code != SQLITE_OK) return code;
  own.base.pMethods = &kMethods;
  own.path = new std::string(name != nullptr ? name : "");
  return SQLITE_OK;
}

int Delete(sqlite3_vfs*, const char* name, int sync) {
  const std::lock_guard lock(TheDisk().mutex);
  TheDisk().files.erase(name);
  return TheDisk().real->xDelete(TheDisk().real, name, sync);
}

void WriteAt(const fs::path& path, sqlite3_int64 at, std::string_view bytes) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(at);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

// Undoes all writes, from the last to the first, and repeats those that the disk happens to have kept.
void Lose(const fs::path& path, const std::vector<Unsynced>& writes, std::mt19937_64& random) {
  for (auto write = writes.rbegin(); write != writes.rend(); ++write) {
    fs::resize_file(path, static_cast<std::uintmax_t>(write->size_before));
    WriteAt(path, write->at, write->before);
  }
  const int kept_in_8 = static_cast<int>(random() % 9);
  for (const Unsynced& write : writes) {
    if (static_cast<int>(random() % 8) >= kept_in_8) continue;
    if (write.is_truncation) {
      fs::resize_file(path, static_cast<std::uintmax_t>(write.at));
      continue;
    }
    const std::size_t sectors = (write.after.size() + kSector - 1) / kSector;
    const bool is_torn = random() % 4 == 0;
    WriteAt(path, write.at,
            std::string_view(write.after).substr(0, is_torn ? random() % sectors * kSector : std::string::npos));
  }
}

}  // namespace

void UseLossyDisk(Syncs syncs) {
  Disk& disk = TheDisk();
  disk.syncs = syncs;
  disk.real = sqlite3_vfs_find(nullptr);
  static sqlite3_vfs vfs = *disk.real;
  vfs.zName = "lossy";
  vfs.szOsFile = static_cast<int>(sizeof(File)) + disk.real->szOsFile;
  vfs.pNext = nullptr;
  vfs.xOpen = &Open;
  vfs.xDelete = &Delete;
  sqlite3_vfs_register(&vfs, 1);
}

void CutPower(const std::string& directory, const std::string& after, std::uint64_t seed) {
  Disk& disk = TheDisk();
  disk.mutex.lock();
  fs::remove_all(after);
  fs::copy(directory, after, fs::copy_options::recursive);
  std::mt19937_64 random(seed);
  for (const auto& [path, writes] : disk.files) {
    if (path.empty()) continue;  // a temporary file
    const fs::path copy = fs::path(after) / fs::relative(path, directory);
    if (!writes.empty() && fs::exists(copy)) Lose(copy, writes, random);
  }
  // Shared memory does not survive.
  for (const auto& entry : fs::recursive_directory_iterator(after)) {
    if (entry.path().string().ends_with("-shm")) fs::remove(entry.path());
  }
}

}  // namespace fascicle::server
