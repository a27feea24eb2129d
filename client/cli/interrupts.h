#ifndef FASCICLE_CLIENT_CLI_INTERRUPTS_H_
#define FASCICLE_CLIENT_CLI_INTERRUPTS_H_

#include <functional>
#include <thread>

namespace fascicle::client {

// While it lives, Ctrl-C and SIGTERM call `on_interrupt` on a thread of their own instead of ending the program; the
// second one ends it at once. To be made before any other thread, so that none of them takes the signals.
class Interrupts {
 public:
  explicit Interrupts(std::function<void()> on_interrupt);
  ~Interrupts();
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

 private:
  std::jthread thread_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_INTERRUPTS_H_
