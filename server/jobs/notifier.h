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

// Notifies listeners of changes from a thread of its own, so that the caller of Notify neither waits for a listener nor
// holds a lock during its call. Changes that come faster than calls are combined. Thread-safe.
class Notifier {
 public:
  using Handle = std::shared_ptr<void>;

  Notifier();
  // Makes the outstanding calls. Handles may outlive the notifier.
  ~Notifier();

  // Calls `listener` after each Notify(id) until the handle is destroyed. Destroying it waits for a call in progress,
  // unless the listener itself does it.
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
