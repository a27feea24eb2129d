#ifndef FASCICLE_CLIENT_RENDER_PICTURE_H_
#define FASCICLE_CLIENT_RENDER_PICTURE_H_

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "client/render/canvas.h"
#include "core/base/types.h"
#include "fascicle/v1/frame.pb.h"

namespace fascicle::client {

// How to draw a frame.
struct PictureOptions {
  PictureSize size;
  // The quantity by which bodies and lines are coloured, see ColourFrames; empty: plain colours.
  std::string colour = "displacement";
  // Range of the colour scale, in the field's unit; by default that of the frames, see ColourFrames.
  std::optional<std::pair<double, double>> range;
  // Names of the values 0, 1, ... of a quantity that numbers parts: each has a colour of its own, with its name beside
  // it in place of a scale. The first one is that of everything else. Empty: a scale.
  std::vector<std::string> categories;
  bool surface = true;
  bool smooth = false;  // smooths the steps between voxels
  bool wireframe = false;
  // Draws the body as a cloud, resampled to a regular grid and cast by rays: the opacity grows with the length of a ray
  // in the body, the colour is the mean along it; with a veil of the body's surface.
  bool volume = false;
  bool rest_outline = true;  // the outline of the rest shape, in front of the body
  bool fibres = false;       // as lines through a transparent surface
  bool rigid_bodies = true;
  bool lines = true;  // as tubes
  // The vertical of the picture, a unit vector along an axis; absent: the floor's normal, or z.
  std::optional<Vec3> up;
  // The viewpoint [degree]: where up is z, azimuth from +x to +y and elevation from the xy plane to +z; otherwise the
  // same with axes that are turned with the vertical (VerticalFrame in view.h). If both are absent, long bodies are
  // seen from the side and others from a corner, and from a corner if `up` is given.
  std::optional<double> azimuth;
  std::optional<double> elevation;
  double zoom = 1;
  std::string title;
  bool time = true;  // shown below the title
};

// Draws a frame of all objects and writes a PNG. Throws std::runtime_error with a message for users.
void DrawPicture(const v1::Geometry& geometry, const v1::Frame& frame, const PictureOptions& options,
                 const std::filesystem::path& path);

// The same for several frames in panels side by side, with the same viewpoint, scale and colours: 1 to 24 frames.
void DrawPanels(const v1::Geometry& geometry, std::span<const v1::Frame> frames, const PictureOptions& options,
                const std::filesystem::path& path);

struct AnimationOptions {
  double frames_per_second = 12;  // (0, 50]
  // 0: one picture per frame; otherwise this number of pictures of the last frame, with a rotating viewpoint.
  int turntable = 0;
};

// Draws the frames in sequence, or the last one with a rotating viewpoint, with the same scale and colours, and writes
// an animated GIF that repeats. `progress` receives the completed fraction.
void DrawAnimation(const v1::Geometry& geometry, std::span<const v1::Frame> frames, const PictureOptions& options,
                   const AnimationOptions& animation, const std::filesystem::path& path,
                   const std::function<void(double)>& progress = {});

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_PICTURE_H_
