#ifndef FASCICLE_CLIENT_RENDER_DISPLAY_H_
#define FASCICLE_CLIENT_RENDER_DISPLAY_H_

#include <memory>

namespace fascicle::client {

// A connection to an X display for off-screen drawing: the one given by $DISPLAY if it responds, otherwise a virtual
// one (Xvfb) that this process starts. Xvfb does not listen on any network and ends with the display, or this process.
class Display {
 public:
  // The one that is open, if any: keep it for several pictures. Throws std::runtime_error with a message for users,
  // such as that Xvfb is missing. From one thread.
  static std::shared_ptr<Display> Open();
  virtual ~Display() = default;
  // Xlib's `Display*`.
  virtual void* native() const = 0;
  virtual bool is_virtual() const = 0;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_DISPLAY_H_
