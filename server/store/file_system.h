#ifndef FASCICLE_SERVER_STORE_FILE_SYSTEM_H_
#define FASCICLE_SERVER_STORE_FILE_SYSTEM_H_

#include <cstdint>
#include <string>

namespace fascicle::server {

// What the standard library leaves out about files. Errors are thrown as StoreError with the file's name.

// Waits until the contents of a file are on the disk.
void SyncFile(const std::string& path);
// Waits until the names in the folder of `path` are on the disk: needed after creating or renaming a file.
void SyncParent(const std::string& path);

// A file that is written from its start to its end.
class FileWriter {
 public:
  explicit FileWriter(const std::string& path);
  ~FileWriter();
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;
  void Write(const char* bytes, std::size_t size);
  // Waits until all is on the disk, and closes.
  void Finish();

 private:
  std::string path_;
  int descriptor_;
};

// Held by one process at a time; released when destroyed, or by the system when the process ends.
class DirectoryLock {
 public:
  // Throws StoreError when somebody else holds it.
  explicit DirectoryLock(const std::string& directory);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  int descriptor_;
};

// True for the types of statfs(2) whose locks and fsync depend on another machine or program: SQLite is not safe there.
bool IsNetworkFilesystem(std::uint64_t statfs_type);
// Throws StoreError when `directory` is on one of these.
void CheckLocal(const std::string& directory);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_FILE_SYSTEM_H_
