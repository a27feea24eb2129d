#ifndef FASCICLE_CLIENT_RENDER_DISPLAY_H_
#define FASCICLE_CLIENT_RENDER_DISPLAY_H_

#include <memory>

namespace fascicle::client {

// A connection to an X display to draw on without a window being shown: the one that $DISPLAY names when it answers,
// otherwise a virtual one (Xvfb) that this process starts, that listens on no network and that ends with it.
class Display {
 public:
  // Throws std::runtime_error with a message for people, such as that Xvfb is missing.
  static std::unique_ptr<Display> Open();
  virtual ~Display() = default;
  // Xlib's `Display*`.
  virtual void* native() const = 0;
  virtual bool is_virtual() const = 0;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_DISPLAY_H_
