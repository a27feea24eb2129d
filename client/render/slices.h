#ifndef FASCICLE_CLIENT_RENDER_SLICES_H_
#define FASCICLE_CLIENT_RENDER_SLICES_H_

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "client/render/canvas.h"
#include "core/base/types.h"

namespace fascicle::client {

// A scan and what was found in it. The spans must outlive the call only.
struct SlicesInput {
  std::array<int, 3> size = {0, 0, 0};   // voxels along i, j, k
  Vec3 spacing = Vec3::Ones();           // [m]
  Mat3 direction = Mat3::Identity();     // columns: unit vectors along i, j, k in DICOM's patient coordinates
  std::span<const float> values;         // of each voxel, i fastest, then j
  std::span<const std::uint8_t> labels;  // likewise; 0: nothing
  std::vector<std::string> names;        // of labels 1, 2, ...
  std::string title;
  // The value drawn in middle grey, and how far black and white are apart; absent: black and white at the 0.5 and 99.5
  // percentiles.
  std::optional<std::pair<double, double>> window;
  // Shows the labelled voxels with a margin around them [m]; absent: the whole image.
  std::optional<double> crop;
};

// Draws four axial slices, evenly over the labelled voxels, and a coronal and a sagittal one through their middle, with
// the outline of each label over the grey values, and writes a PNG. As radiologists look at them: the patient's left is
// at the right, the front above in axial slices and at the left in sagittal ones, the head above. Axes of the image
// count as those of the patient that are nearest; letters mark the sides (R, L, A, P, H, F). All at one scale, with a
// bar of known length, in a picture that is not higher than they need. Throws std::runtime_error with a message for
// people.
void DrawSlices(const SlicesInput& input, PictureSize size, const std::filesystem::path& path);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_SLICES_H_
