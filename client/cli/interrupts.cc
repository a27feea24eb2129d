#include "client/cli/interrupts.h"

#include <csignal>
#include <cstdlib>
#include <ctime>
#include <stop_token>
#include <utility>

#include "client/cli/command.h"

namespace fascicle::client {
namespace {

sigset_t Signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

}  // namespace

Interrupts::Interrupts(std::function<void()> on_interrupt) {
  const sigset_t signals = Signals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  thread_ = std::jthread([on_interrupt = std::move(on_interrupt)](const std::stop_token& stop) {
    const sigset_t waited = Signals();
    bool interrupted = false;
    while (!stop.stop_requested()) {
      const timespec patience = {0, 50'000'000};
      if (sigtimedwait(&waited, nullptr, &patience) < 0) continue;
      if (interrupted) std::_Exit(kCancelled);
      interrupted = true;
      on_interrupt();
    }
  });
}

Interrupts::~Interrupts() {
  thread_.request_stop();
  thread_.join();
  const sigset_t signals = Signals();
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
}

}  // namespace fascicle::client
