#ifndef FASCICLE_SERVER_JOBS_NOTIFIER_H_
#define FASCICLE_SERVER_JOBS_NOTIFIER_H_

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace fascicle::server {

// Tells listeners that something has changed, from a thread of its own: whoever makes the change neither waits for a
// listener nor lends it the locks it holds. Changes that come faster than they are told are told once. Thread-safe.
class Notifier {
 public:
  using Handle = std::shared_ptr<void>;

  Notifier();
  // Tells what is still to be told. Handles may live on.
  ~Notifier();

  // Calls `listener` after each Notify(id) until the handle is gone. Destroying the handle waits for a call that is
  // under way, unless it is the listener itself that does it.
  Handle Subscribe(std::string_view id, std::function<void()> listener);
  void Notify(std::string_view id);

 private:
  struct Listener;
  struct Registry;

  void Loop(const std::stop_token& stop);

  const std::shared_ptr<Registry> registry_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::set<std::string, std::less<>> pending_;
  std::jthread thread_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_NOTIFIER_H_
