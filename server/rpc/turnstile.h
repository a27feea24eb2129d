#ifndef FASCICLE_SERVER_RPC_TURNSTILE_H_
#define FASCICLE_SERVER_RPC_TURNSTILE_H_

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <mutex>

#include "server/rpc/executor.h"

namespace fascicle::server {

// Lets a few large writes begin at a time, in the order of their arrival. Otherwise the writes of many fast readers
// stand before every small answer. A write that takes long, because its reader is slow, gives its place to the next.
// Thread-safe.
class Turnstile {
 public:
  // Calls come from `executor`, which must not run any more when this is destroyed.
  Turnstile(Executor& executor, std::size_t places) : executor_(executor), places_(places) {}

  // Calls `go` when there is a place: at once, or later from the executor. `who` must not be there already.
  void Enter(const void* who, std::function<void()> go);
  // The write has ended. Does nothing if `who` has no place.
  void Leave(const void* who);

 private:
  using Clock = std::chrono::steady_clock;

  struct Waiting {
    const void* who;
    std::function<void()> go;
  };

  // The functions below need `mutex_`.
  void DropSlow();
  void Admit();
  void WatchSlow();

  Executor& executor_;
  const std::size_t places_;
  std::mutex mutex_;
  std::map<const void*, Clock::time_point> inside_;  // since when
  std::deque<Waiting> waiting_;
  bool watching_ = false;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_TURNSTILE_H_
