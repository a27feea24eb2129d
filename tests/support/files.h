#ifndef FASCICLE_TESTS_SUPPORT_FILES_H_
#define FASCICLE_TESTS_SUPPORT_FILES_H_

#include <filesystem>
#include <string>

// Files of tests. Thread-safe.
namespace fascicle::testing {

// An empty folder, removed at the end with its contents.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  // The path of an entry of the folder.
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  // Writes a file in the folder, and returns its path.
  std::string Write(const std::string& name, const std::string& bytes) const;

 private:
  std::filesystem::path path_;
};

// All bytes of a file; none if it cannot be read.
std::string ReadFile(const std::filesystem::path& path);
void WriteFile(const std::filesystem::path& path, const std::string& bytes);

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_FILES_H_
