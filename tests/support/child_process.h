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

// The result of a program.
struct Finished {
  int exit_code = -1;  // negative: the signal that ended it
  std::string out;
  std::string err;
};

// A program that runs beside the test and is killed with it at the latest. Not thread-safe.
class ChildProcess {
 public:
  // `environment` is added to this process's own; an empty value removes a variable.
  explicit ChildProcess(std::vector<std::string> command, const std::map<std::string, std::string>& environment = {});
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // The next line of its stdout; empty at the end, or if none arrives within `timeout`.
  std::string ReadLine(std::chrono::milliseconds timeout = std::chrono::seconds(30));
  void Signal(int signal) const;
  // Waits until the program has blocked a signal, so that it handles it by itself; false if it ends before.
  bool AwaitBlocked(int signal) const;
  // The exit code, or minus the signal that ended it; nothing if it still runs after `timeout`.
  std::optional<int> Wait(std::chrono::milliseconds timeout);
  // Waits for its end; `out` is the output that ReadLine has not returned.
  Finished Wait();

  // Everything written so far.
  std::string Output() const { return ReadFile(output_ / "out"); }
  std::string ErrorOutput() const { return ReadFile(output_ / "err"); }
  // Resident memory of the process without files [byte].
  std::int64_t ResidentBytes() const;
  // The largest resident memory, with files, since the start or the last ForgetPeak [byte].
  std::int64_t PeakBytes() const;
  void ForgetPeak() const;
  // Processor time that it has used [s].
  double CpuSeconds() const;
  // The same of its threads with this niceness.
  double CpuSeconds(int niceness) const;

 private:
  std::int64_t StatusBytes(const std::string& entry) const;

  TemporaryFolder output_;
  std::size_t read_ = 0;  // [byte] of the output, by ReadLine
  pid_t pid_ = -1;
  std::optional<int> exit_code_;
};

Finished RunProgram(const std::vector<std::string>& command,
                    const std::map<std::string, std::string>& environment = {});

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_CHILD_PROCESS_H_
