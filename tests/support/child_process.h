#ifndef FASCICLE_TESTS_SUPPORT_CHILD_PROCESS_H_
#define FASCICLE_TESTS_SUPPORT_CHILD_PROCESS_H_

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace fascicle::testing {

// What a program left behind.
struct Finished {
  int exit_code = -1;  // negative: the signal that ended it
  std::string out;
  std::string err;
};

// A program that runs beside the test; killed in the end.
class ChildProcess {
 public:
  // `environment` is added to this process's own; an empty value removes a variable.
  explicit ChildProcess(const std::vector<std::string>& command,
                        const std::map<std::string, std::string>& environment = {});
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // The next line of its stdout; empty at the end, or when none comes within `seconds`.
  std::string ReadLine(double seconds = 30);
  void Signal(int signal) const;
  // Waits for its end and returns what it wrote since.
  Finished Wait();

 private:
  pid_t pid_ = -1;
  int out_ = -1;
  std::filesystem::path err_file_;
};

Finished RunProgram(const std::vector<std::string>& command,
                    const std::map<std::string, std::string>& environment = {});

// An empty folder that is removed in the end.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

std::string ReadText(const std::filesystem::path& path);
void WriteText(const std::filesystem::path& path, const std::string& text);

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_CHILD_PROCESS_H_
