#ifndef FASCICLE_CLIENT_CLI_INTERRUPTS_H_
#define FASCICLE_CLIENT_CLI_INTERRUPTS_H_

#include <functional>
#include <stop_token>
#include <thread>

namespace fascicle::client {

// While this object lives, Ctrl-C and SIGTERM call `on_interrupt` on a separate thread instead of ending the program; a
// second one ends it at once. Create it before any other thread, so that no thread receives the signals.
class Interrupts {
 public:
  explicit Interrupts(std::function<void()> on_interrupt);
  ~Interrupts();
  Interrupts(const Interrupts&) = delete;
  Interrupts& operator=(const Interrupts&) = delete;

 private:
  std::jthread thread_;
};

// The same for work that checks a stop token.
class StopOnInterrupt {
 public:
  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  Interrupts interrupts_ = Interrupts([this] { source_.request_stop(); });
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_INTERRUPTS_H_
