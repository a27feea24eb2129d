#ifndef FASCICLE_CLIENT_LIB_BACKOFF_H_
#define FASCICLE_CLIENT_LIB_BACKOFF_H_

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <random>
#include <stop_token>

namespace fascicle::client {

// Delays between attempts: from 50 ms, doubling up to 1 s, each shortened at random by up to a half, so that many
// clients do not reconnect simultaneously. Not thread-safe.
class Backoff {
 public:
  // Call after a success.
  void Reset() { delay_ = kShortest; }

  // Waits, at least for `at_least`; a stop request ends the delay.
  void Wait(std::chrono::milliseconds at_least = {}, const std::stop_token& stop = {}) {
    std::uniform_real_distribution<double> part(0.5, 1);
    const auto delay = std::chrono::duration_cast<std::chrono::milliseconds>(delay_ * part(random_));
    delay_ = std::min(2 * delay_, kLongest);
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, std::max(delay, at_least), [] { return false; });
  }

 private:
  static constexpr std::chrono::milliseconds kShortest{50};
  static constexpr std::chrono::milliseconds kLongest{1000};

  std::chrono::milliseconds delay_ = kShortest;
  std::minstd_rand random_{std::random_device{}()};
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_BACKOFF_H_
