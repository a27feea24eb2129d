#ifndef FASCICLE_TESTS_SUPPORT_SERVER_PROCESS_H_
#define FASCICLE_TESTS_SUPPORT_SERVER_PROCESS_H_

#include <chrono>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/child_process.h"
#include "tests/support/paths.h"

namespace fascicle::testing {

// The real `fascicled` as a child.
class ServerProcess : public ChildProcess {
 public:
  // `environment`: as that of a ChildProcess.
  explicit ServerProcess(std::vector<std::string> options, const std::map<std::string, std::string>& environment = {})
      : ChildProcess(Command(std::move(options)), environment) {}

  // HOST:PORT once the server is ready; empty if it has ended or takes longer than `timeout`. Call once.
  std::string AwaitAddress(std::chrono::seconds timeout = std::chrono::seconds(20)) {
    const std::string prefix = "listening on ";
    const std::string line = ReadLine(timeout);
    return line.starts_with(prefix) ? line.substr(prefix.size()) : "";
  }

 private:
  static std::vector<std::string> Command(std::vector<std::string> options) {
    options.insert(options.begin(), Program("fascicled"));
    return options;
  }
};

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_SERVER_PROCESS_H_
