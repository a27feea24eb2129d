#ifndef FASCICLE_CLIENT_RENDER_PICTURE_H_
#define FASCICLE_CLIENT_RENDER_PICTURE_H_

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "client/render/canvas.h"
#include "fascicle/v1/frame.pb.h"

namespace fascicle::client {

// How a frame is drawn.
struct PictureOptions {
  PictureSize size;
  // What the surface is coloured by, see ValuesAtNodes; empty: a plain colour.
  std::string colour = "displacement";
  // Values at the ends of the colour scale, in the field's unit; those of the frame when absent.
  std::optional<std::pair<double, double>> range;
  bool surface = true;
  bool wireframe = false;
  bool rest_outline = true;  // the outline of the rest shape, over the body
  bool fibres = false;       // as lines through a transparent surface
  // Where the eye stands [degree]: azimuth from +x to +y, elevation from the xy plane to +z. When both are absent, a
  // body much longer than wide lies across the picture, others are seen from a corner.
  std::optional<double> azimuth;
  std::optional<double> elevation;
  double zoom = 1;
  std::string title;
  bool time = true;  // below the title
};

// Draws a frame of all bodies and writes a PNG. Throws std::runtime_error with a message for people.
void DrawPicture(const v1::Geometry& geometry, const v1::Frame& frame, const PictureOptions& options,
                 const std::filesystem::path& path);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_PICTURE_H_
