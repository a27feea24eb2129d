#ifndef FASCICLE_CLIENT_RENDER_SLICES_H_
#define FASCICLE_CLIENT_RENDER_SLICES_H_

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "client/render/canvas.h"
#include "core/base/types.h"

namespace fascicle::client {

// A scan and what was found in it. The spans must outlive the call only.
struct SlicesInput {
  std::array<int, 3> size = {0, 0, 0};   // voxels along i, j, k
  Vec3 spacing = Vec3::Ones();           // [m]
  std::span<const float> values;         // of each voxel, i fastest, then j
  std::span<const std::uint8_t> labels;  // likewise; 0: nothing
  std::vector<std::string> names;        // of labels 1, 2, ...
  std::string title;
};

// Draws four slices across k, evenly over the labelled voxels, and one across j and i through their middle, with the
// outline of each label over the grey values (black and white at their 0.5 and 99.5 percentiles), and writes a PNG.
// j runs down and k up. All at one scale, with a bar of known length. Throws std::runtime_error with a message for
// people.
void DrawSlices(const SlicesInput& input, PictureSize size, const std::filesystem::path& path);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_SLICES_H_
