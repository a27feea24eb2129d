#ifndef FASCICLE_TESTS_SUPPORT_STAGE_WATCH_H_
#define FASCICLE_TESTS_SUPPORT_STAGE_WATCH_H_

#include <atomic>
#include <cstdint>
#include <stop_token>
#include <string>
#include <thread>

#include "core/base/profile.h"

namespace fascicle::testing {

// How often a stage has been entered so far, such as "step/Newton".
inline std::int64_t CallsOf(const Profile& profile, const std::string& stage) {
  for (const ProfileStage& entered : profile.Stages()) {
    if (entered.name == stage) return entered.calls;
  }
  return 0;
}

// Requests a stop, from its own thread, once a stage of another thread has been entered a given number of times.
class StopAtStage {
 public:
  StopAtStage(const Profile& profile, std::string stage, std::int64_t calls = 1)
      : thread_([this, &profile, stage = std::move(stage), calls](const std::stop_token& enough) {
          while (CallsOf(profile, stage) < calls && !enough.stop_requested()) std::this_thread::yield();
          source_.request_stop();
          calls_at_stop_ = CallsOf(profile, stage);
        }) {}

  std::stop_token token() const { return source_.get_token(); }
  // The number of entries of the stage shortly after the request. Call after the watched work has ended.
  std::int64_t CallsAtStop() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
    return calls_at_stop_;
  }

 private:
  std::stop_source source_;
  std::atomic<std::int64_t> calls_at_stop_ = 0;
  std::jthread thread_;
};

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_STAGE_WATCH_H_
