#ifndef FASCICLE_TESTS_SUPPORT_EVENTUALLY_H_
#define FASCICLE_TESTS_SUPPORT_EVENTUALLY_H_

#include <chrono>
#include <functional>
#include <thread>

namespace fascicle::testing {

// Waits until `condition` holds; false if it does not within `timeout`.
inline bool Eventually(const std::function<bool()>& condition,
                       std::chrono::milliseconds timeout = std::chrono::seconds(30)) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_EVENTUALLY_H_
