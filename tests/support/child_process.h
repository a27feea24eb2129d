#ifndef FASCICLE_TESTS_SUPPORT_CHILD_PROCESS_H_
#define FASCICLE_TESTS_SUPPORT_CHILD_PROCESS_H_

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/files.h"

namespace fascicle::testing {

// What a program left behind.
struct Finished {
  int exit_code = -1;  // negative: the signal that ended it
  std::string out;
  std::string err;
};

// A program that runs beside the test, and ends with it at the latest. Not thread-safe.
class ChildProcess {
 public:
  // `environment` is added to this process's own; an empty value removes a variable.
  explicit ChildProcess(std::vector<std::string> command, const std::map<std::string, std::string>& environment = {});
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // The next line of its stdout; empty at the end, or when none comes within `timeout`.
  std::string ReadLine(std::chrono::milliseconds timeout = std::chrono::seconds(30));
  void Signal(int signal) const;
  // The exit code, or the signal that ended it, negative; nothing when it still runs after `timeout`.
  std::optional<int> Wait(std::chrono::milliseconds timeout);
  // Waits for its end; `out` is what ReadLine has not returned.
  Finished Wait();

  // All that it has written until now.
  std::string Output() const { return ReadFile(output_ / "out"); }
  std::string ErrorOutput() const { return ReadFile(output_ / "err"); }
  // Memory of the process that is in RAM and not of files [byte].
  std::int64_t ResidentBytes() const;

 private:
  TemporaryFolder output_;
  std::size_t read_ = 0;  // [byte] of the output, by ReadLine
  pid_t pid_ = -1;
  std::optional<int> exit_code_;
};

Finished RunProgram(const std::vector<std::string>& command,
                    const std::map<std::string, std::string>& environment = {});

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_CHILD_PROCESS_H_
