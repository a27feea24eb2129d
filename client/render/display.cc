#include "client/render/display.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

#include <X11/Xlib.h>

namespace fascicle::client {
namespace {

using XDisplay = ::Display;
constexpr std::chrono::seconds kPatience{20};

// The program of a virtual display.
class Xvfb {
 public:
  Xvfb() {
    int pipe_ends[2];
    if (pipe2(pipe_ends, O_CLOEXEC) != 0)
      throw std::runtime_error(std::string("can't make a pipe: ") + std::strerror(errno));
    const pid_t parent = getpid();
    pid_ = fork();
    if (pid_ == 0) Exec(pipe_ends[1], parent);
    close(pipe_ends[1]);
    if (pid_ > 0) number_ = ReadNumber(pipe_ends[0]);
    close(pipe_ends[0]);
    if (number_.empty()) {
      Kill();
      throw std::runtime_error(
          "there is no display, and the virtual one (Xvfb) did not start; on Debian: apt-get install xvfb");
    }
  }
  ~Xvfb() { Kill(); }
  Xvfb(const Xvfb&) = delete;
  Xvfb& operator=(const Xvfb&) = delete;

  std::string name() const { return ":" + number_; }

 private:
  // Only calls that are safe between fork and exec.
  [[noreturn]] static void Exec(int number_end, pid_t parent) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);  // the parent ended before the previous line
    setsid();                             // Ctrl-C is for the parent only
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    dup2(number_end, 3);  // also clears close-on-exec, except for a pipe that already is 3
    fcntl(3, F_SETFD, 0);
    const int nowhere = open("/dev/null", O_RDWR);
    for (int stream = 0; stream < 3; ++stream) dup2(nowhere, stream);
    execlp("Xvfb", "Xvfb", "-displayfd", "3", "-screen", "0", "640x480x24", "-nolisten", "tcp", "-noreset", nullptr);
    _exit(127);
  }

  // The digits up to the end of the line; empty if the program ended or took too long.
  static std::string ReadNumber(int end) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    std::string number;
    for (char c = 0; c != '\n';) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
      pollfd waiting = {end, POLLIN, 0};
      const int ready = left.count() > 0 ? poll(&waiting, 1, static_cast<int>(left.count())) : 0;
      if (ready < 0 && errno == EINTR) continue;
      if (ready <= 0 || read(end, &c, 1) != 1) return "";
      if (c >= '0' && c <= '9') number += c;
    }
    return number;
  }

  void Kill() {
    if (pid_ <= 0) return;
    kill(pid_, SIGTERM);
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
  }

  pid_t pid_ = -1;
  std::string number_;
};

class OpenDisplay final : public Display {
 public:
  // Declared before the connection, so that it is destroyed after it.
  std::unique_ptr<Xvfb> xvfb;
  XDisplay* connection = nullptr;

  ~OpenDisplay() override {
    if (connection != nullptr) XCloseDisplay(connection);
  }
  void* native() const override { return connection; }
  bool is_virtual() const override { return xvfb != nullptr; }
};

}  // namespace

std::shared_ptr<Display> Display::Open() {
  static std::weak_ptr<Display> open;
  if (std::shared_ptr<Display> display = open.lock()) return display;
  auto display = std::make_shared<OpenDisplay>();
  const char* wanted = std::getenv("DISPLAY");
  if (wanted != nullptr && *wanted != '\0') display->connection = XOpenDisplay(wanted);
  if (display->connection == nullptr) {
    display->xvfb = std::make_unique<Xvfb>();
    display->connection = XOpenDisplay(display->xvfb->name().c_str());
  }
  if (display->connection == nullptr) throw std::runtime_error("the virtual display (Xvfb) does not answer");
  open = display;
  return display;
}

}  // namespace fascicle::client
