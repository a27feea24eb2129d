#ifndef FASCICLE_TESTS_SUPPORT_CALL_TIMES_H_
#define FASCICLE_TESTS_SUPPORT_CALL_TIMES_H_

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace fascicle::testing {

// Times of calls that a thread makes again and again, from the constructor to Stop.
class CallTimes {
 public:
  // `call` returns false if it failed. The next one starts `pause` after the end of the last one.
  explicit CallTimes(std::function<bool()> call, std::chrono::milliseconds pause = std::chrono::milliseconds(5))
      : call_(std::move(call)), thread_([this, pause] {
          while (!stop_) {
            MakeCall();
            std::this_thread::sleep_for(pause);
          }
        }) {}
  ~CallTimes() { Stop(); }

  void Stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  // The time within which `part` of the calls so far ended [s]; 0 without calls.
  double Quantile(double part) const {
    const std::lock_guard lock(mutex_);
    if (seconds_.empty()) return 0;
    std::vector<double> sorted = seconds_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(part * static_cast<double>(sorted.size())))];
  }
  std::size_t count() const {
    const std::lock_guard lock(mutex_);
    return seconds_.size();
  }
  int failures() const { return failures_; }
  // "p50 1.2 ms, p99 3.4 ms of 1000 calls".
  std::string Summary() const {
    const auto ms = [this](double part) { return std::to_string(1e3 * Quantile(part)).substr(0, 5); };
    return "p50 " + ms(0.5) + " ms, p99 " + ms(0.99) + " ms of " + std::to_string(count()) + " calls, " +
           std::to_string(failures_) + " failed";
  }

 private:
  void MakeCall() {
    const auto start = std::chrono::steady_clock::now();
    if (!call_()) ++failures_;
    const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::lock_guard lock(mutex_);
    seconds_.push_back(taken);
  }

  const std::function<bool()> call_;
  mutable std::mutex mutex_;
  std::vector<double> seconds_;
  std::atomic<int> failures_ = 0;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_CALL_TIMES_H_
