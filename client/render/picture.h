#ifndef FASCICLE_CLIENT_RENDER_PICTURE_H_
#define FASCICLE_CLIENT_RENDER_PICTURE_H_

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "client/render/canvas.h"
#include "fascicle/v1/frame.pb.h"

namespace fascicle::client {

// How a frame is drawn.
struct PictureOptions {
  PictureSize size;
  // What bodies and lines are coloured by, see ColourFrames; empty: plain colours.
  std::string colour = "displacement";
  // Values at the ends of the colour scale, in the field's unit; those of the frame when absent.
  std::optional<std::pair<double, double>> range;
  bool surface = true;
  bool smooth = false;  // the surface's steps between voxels away
  bool wireframe = false;
  // The body as a cloud, resampled to a regular grid and cast through by rays: the longer its way, the denser, coloured
  // by the mean of what it meets, in a veil of the body's surface.
  bool volume = false;
  bool rest_outline = true;  // the outline of the rest shape, over the body
  bool fibres = false;       // as lines through a transparent surface
  bool rigid_bodies = true;
  bool lines = true;  // as tubes
  // Where the eye stands [degree]: azimuth from +x to +y, elevation from the xy plane to +z. When both are absent, a
  // body much longer than wide lies across the picture, others are seen from a corner; up is z, or out of the floor.
  std::optional<double> azimuth;
  std::optional<double> elevation;
  double zoom = 1;
  std::string title;
  bool time = true;  // below the title
};

// Draws a frame of all objects and writes a PNG. Throws std::runtime_error with a message for people.
void DrawPicture(const v1::Geometry& geometry, const v1::Frame& frame, const PictureOptions& options,
                 const std::filesystem::path& path);

// The same of several frames in panels side by side, with the same eye, scale and colours: at least one, at most 24.
void DrawPanels(const v1::Geometry& geometry, std::span<const v1::Frame> frames, const PictureOptions& options,
                const std::filesystem::path& path);

struct AnimationOptions {
  double frames_per_second = 12;  // (0, 50]
  // One frame, the eye going round it in so many pictures; 0: the frames one after the other.
  int turntable = 0;
};

// Draws the frames one after the other, or goes round the last of them, with the same scale and colours, and writes an
// animated GIF that repeats. `progress` gets the part that is done.
void DrawAnimation(const v1::Geometry& geometry, std::span<const v1::Frame> frames, const PictureOptions& options,
                   const AnimationOptions& animation, const std::filesystem::path& path,
                   const std::function<void(double)>& progress = {});

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_PICTURE_H_
