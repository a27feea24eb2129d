#ifndef FASCICLE_TESTS_SUPPORT_SERVER_PROCESS_H_
#define FASCICLE_TESTS_SUPPORT_SERVER_PROCESS_H_

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace fascicle::service_test {

// A folder of its own, removed with all that is in it.
class TemporaryFolder {
 public:
  TemporaryFolder() : path_((std::filesystem::temp_directory_path() / "fascicle-service-XXXXXX").string()) {
    if (mkdtemp(path_.data()) == nullptr) throw std::runtime_error("no temporary folder");
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// The real `fascicled`, as a child that dies with this process.
class ServerProcess {
 public:
  // Starts the program (the macro FASCICLED). Its output goes to files.
  explicit ServerProcess(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), FASCICLED);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    const std::string out = output_.path() + "/out", err = output_.path() + "/err";
    pid_ = fork();
    if (pid_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
      dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
      execv(argv[0], argv.data());
      _exit(127);
    }
    if (pid_ < 0) throw std::runtime_error("fork failed");
  }
  ~ServerProcess() {
    Signal(SIGKILL);
    Wait(std::chrono::seconds(10));
  }
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  // Waits for the line that tells that the server is ready; nothing when it ended or took too long.
  std::optional<std::string> Address(std::chrono::seconds timeout = std::chrono::seconds(20)) {
    const std::string prefix = "listening on ";
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    while (std::chrono::steady_clock::now() < deadline) {
      const std::string text = Output();
      if (text.starts_with(prefix) && text.ends_with("\n"))
        return text.substr(prefix.size(), text.size() - prefix.size() - 1);
      if (Wait(std::chrono::milliseconds(5))) return std::nullopt;
    }
    return std::nullopt;
  }

  void Signal(int signal) {
    if (!exit_status_) kill(pid_, signal);
  }

  // The exit code, 128 + the signal that ended it, or nothing when it still runs after `timeout`.
  std::optional<int> Wait(std::chrono::milliseconds timeout) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    while (!exit_status_) {
      int status = 0;
      if (waitpid(pid_, &status, WNOHANG) == pid_) {
        exit_status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      } else if (std::chrono::steady_clock::now() >= deadline) {
        return std::nullopt;
      } else {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    }
    return exit_status_;
  }

  std::string Output() const { return Read("/out"); }
  std::string ErrorOutput() const { return Read("/err"); }

  // Memory of the process that is in RAM and not of files [byte].
  std::int64_t ResidentBytes() const {
    std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
    for (std::string word; status >> word;) {
      if (word != "RssAnon:") continue;
      std::int64_t kib = 0;
      status >> kib;
      return kib * 1024;
    }
    return 0;
  }

 private:
  std::string Read(const std::string& name) const {
    std::ifstream in(output_.path() + name);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }

  TemporaryFolder output_;
  pid_t pid_ = -1;
  std::optional<int> exit_status_;
};

}  // namespace fascicle::service_test

#endif  // FASCICLE_TESTS_SUPPORT_SERVER_PROCESS_H_
