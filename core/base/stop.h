#ifndef FASCICLE_CORE_BASE_STOP_H_
#define FASCICLE_CORE_BASE_STOP_H_

#include <exception>
#include <stop_token>

namespace fascicle {

// Ends work that was asked to stop. Not a failure: whoever asked catches it. What the work was about to make is
// incomplete and must be discarded.
class Stopped : public std::exception {
 public:
  const char* what() const noexcept override { return "stopped on request"; }
};

inline void ThrowIfStopped(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Stopped();
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_STOP_H_
