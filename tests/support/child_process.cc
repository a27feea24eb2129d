#include "tests/support/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace fascicle::testing {
namespace {

namespace fs = std::filesystem;

std::string TemporaryName(const char* pattern) { return (fs::temp_directory_path() / pattern).string(); }

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command,
                           const std::map<std::string, std::string>& environment) {
  std::string err_name = TemporaryName("fascicle-test-err-XXXXXX");
  const int err = mkostemp(err_name.data(), O_CLOEXEC);
  err_file_ = err_name;
  int ends[2];
  if (err < 0 || pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("can't make a pipe");
  std::vector<std::string> arguments = command;
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) {
    const int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, STDIN_FILENO);
    dup2(ends[1], STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
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
  close(ends[1]);
  close(err);
  out_ = ends[0];
}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  if (out_ >= 0) close(out_);
  std::error_code ignored;
  fs::remove(err_file_, ignored);
}

std::string ChildProcess::ReadLine(double seconds) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  std::string line;
  for (char c = 0;;) {
    const auto left = std::chrono::duration<double>(deadline - std::chrono::steady_clock::now()).count();
    pollfd waiting = {out_, POLLIN, 0};
    if (left <= 0 || poll(&waiting, 1, static_cast<int>(1e3 * left) + 1) <= 0) return "";
    if (read(out_, &c, 1) != 1) return line;
    if (c == '\n') return line;
    line += c;
  }
}

void ChildProcess::Signal(int signal) const { kill(pid_, signal); }

Finished ChildProcess::Wait() {
  Finished finished;
  char buffer[65536];
  for (;;) {
    const ssize_t count = read(out_, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    finished.out.append(buffer, static_cast<std::size_t>(count));
  }
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  finished.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  finished.err = ReadText(err_file_);
  return finished;
}

Finished RunProgram(const std::vector<std::string>& command, const std::map<std::string, std::string>& environment) {
  return ChildProcess(command, environment).Wait();
}

ScratchFolder::ScratchFolder() {
  std::string name = TemporaryName("fascicle-test-XXXXXX");
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("can't make " + name);
  path_ = fs::canonical(name);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string ReadText(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void WriteText(const fs::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
}

}  // namespace fascicle::testing
