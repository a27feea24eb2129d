#ifndef FASCICLE_SERVER_STORE_FILE_SYSTEM_H_
#define FASCICLE_SERVER_STORE_FILE_SYSTEM_H_

#include <cstdint>
#include <string>

namespace fascicle::server {

// File operations that the standard library lacks. Errors are thrown as StoreError with the file's name.

// Waits until the contents of a file are on disk.
void SyncFile(const std::string& path);
// Waits until the entries of the folder of `path` are on disk: needed after creating or renaming a file.
void SyncParent(const std::string& path);

// A file that is written sequentially.
class FileWriter {
 public:
  explicit FileWriter(const std::string& path);
  ~FileWriter();
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;
  void Write(const char* bytes, std::size_t size);
  // Waits until everything is on disk, and closes.
  void Finish();

 private:
  std::string path_;
  int descriptor_;
};

// A lock held by one process at a time; released by the destructor, or by the system when the process ends.
class DirectoryLock {
 public:
  // Throws StoreError if another process holds it.
  explicit DirectoryLock(const std::string& directory);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

  // False once the lock's file, or the whole directory, was removed or replaced: another process may use it then.
  bool IsThere() const;

 private:
  const std::string path_;
  int descriptor_;
};

// Whether locks and fsync of a filesystem type (statfs(2)) depend on another machine or program: SQLite is not safe
// there.
bool IsNetworkFilesystem(std::uint64_t statfs_type);
// Throws StoreError if `directory` is on such a filesystem.
void CheckLocal(const std::string& directory);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_FILE_SYSTEM_H_
