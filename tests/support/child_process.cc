#include "tests/support/child_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <thread>

namespace fascicle::testing {
namespace {

using std::chrono::steady_clock;

void Redirect(int descriptor, const std::string& file, int flags) { dup2(open(file.c_str(), flags, 0600), descriptor); }

struct Stat {
  double seconds = 0;  // processor time
  int niceness = 0;
};

// Of a process or a thread.
Stat StatOf(const std::string& file) {
  std::ifstream stat(file);
  std::string skipped;
  for (int i = 0; i < 13; ++i) stat >> skipped;  // the name of the program has no space
  Stat read;
  double user = 0, system = 0;
  stat >> user >> system >> skipped >> skipped >> skipped >> read.niceness;
  read.seconds = (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
  return read;
}

}  // namespace

ChildProcess::ChildProcess(std::vector<std::string> command, const std::map<std::string, std::string>& environment) {
  const std::string out = output_ / "out", err = output_ / "err";
  std::vector<char*> argv;
  for (std::string& argument : command) argv.push_back(argument.data());
  argv.push_back(nullptr);
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("can't start " + command.front());
  if (pid_ > 0) return;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  Redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
  Redirect(STDOUT_FILENO, out, O_WRONLY | O_CREAT | O_APPEND);
  Redirect(STDERR_FILENO, err, O_WRONLY | O_CREAT | O_APPEND);
  for (const auto& [name, value] : environment) {
    if (value.empty()) {
      unsetenv(name.c_str());
    } else {
      setenv(name.c_str(), value.c_str(), 1);
    }
  }
  execv(argv[0], argv.data());
  _exit(127);
}

ChildProcess::~ChildProcess() {
  Signal(SIGKILL);
  Wait(std::chrono::seconds(10));
}

std::string ChildProcess::ReadLine(std::chrono::milliseconds timeout) {
  const auto deadline = steady_clock::now() + timeout;
  for (;;) {
    const bool ended = Wait(std::chrono::milliseconds(0)).has_value();  // asked first: nothing is written afterwards
    const std::string text = Output();
    const std::size_t end = text.find('\n', read_);
    if (end != std::string::npos || ended) {
      std::string line = text.substr(read_, end == std::string::npos ? end : end - read_);
      read_ = end == std::string::npos ? text.size() : end + 1;
      return line;
    }
    if (steady_clock::now() > deadline) return "";
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

void ChildProcess::Signal(int signal) const {
  if (!exit_code_) kill(pid_, signal);
}

bool ChildProcess::AwaitBlocked(int signal) const {
  while (true) {
    std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
    std::string line;
    while (std::getline(status, line) && !line.starts_with("SigBlk:")) {
      if (line.starts_with("State:") && line.find('Z') != std::string::npos) return false;
    }
    if (!status) return false;
    if ((std::stoull(line.substr(7), nullptr, 16) >> (signal - 1) & 1) != 0) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

std::optional<int> ChildProcess::Wait(std::chrono::milliseconds timeout) {
  const auto deadline = steady_clock::now() + timeout;
  while (!exit_code_) {
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) == pid_) {
      exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    } else if (steady_clock::now() >= deadline) {
      return std::nullopt;
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
  return exit_code_;
}

Finished ChildProcess::Wait() {
  Finished finished;
  finished.exit_code = *Wait(std::chrono::hours(24));
  finished.out = Output().substr(read_);
  finished.err = ErrorOutput();
  return finished;
}

std::int64_t ChildProcess::ResidentBytes() const { return StatusBytes("RssAnon:"); }

std::int64_t ChildProcess::PeakBytes() const { return StatusBytes("VmHWM:"); }

void ChildProcess::ForgetPeak() const { std::ofstream("/proc/" + std::to_string(pid_) + "/clear_refs") << 5; }

double ChildProcess::CpuSeconds() const { return StatOf("/proc/" + std::to_string(pid_) + "/stat").seconds; }

double ChildProcess::CpuSeconds(int niceness) const {
  double seconds = 0;
  std::error_code ended;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/" + std::to_string(pid_) + "/task", ended)) {
    const Stat stat = StatOf(thread.path() / "stat");
    if (stat.niceness == niceness) seconds += stat.seconds;
  }
  return seconds;
}

std::int64_t ChildProcess::StatusBytes(const std::string& entry) const {
  std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
  for (std::string word; status >> word;) {
    if (word != entry) continue;
    std::int64_t kib = 0;
    status >> kib;
    return kib * 1024;
  }
  return 0;
}

Finished RunProgram(const std::vector<std::string>& command, const std::map<std::string, std::string>& environment) {
  return ChildProcess(command, environment).Wait();
}

}  // namespace fascicle::testing
