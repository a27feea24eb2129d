#ifndef FASCICLE_CORE_BASE_STOP_H_
#define FASCICLE_CORE_BASE_STOP_H_

#include <algorithm>
#include <exception>
#include <functional>
#include <stop_token>

namespace fascicle {

// Thrown to end work after a stop request. It is not a failure; the requester catches it. Unfinished results must be
// discarded.
class Stopped : public std::exception {
 public:
  const char* what() const noexcept override { return "stopped on request"; }
};

inline void ThrowIfStopped(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Stopped();
}

// Like std::sort. Throws Stopped after a stop request; the items are then in an unspecified order.
template <class Items, class Less = std::less<>>
void SortUnlessStopped(Items& items, const std::stop_token& stop, const Less& less = {}) {
  std::sort(items.begin(), items.end(), [&](const auto& a, const auto& b) {
    ThrowIfStopped(stop);
    return less(a, b);
  });
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_STOP_H_
