#ifndef FASCICLE_CLIENT_RENDER_BODY_LABELS_H_
#define FASCICLE_CLIENT_RENDER_BODY_LABELS_H_

#include <array>
#include <cstdint>
#include <vector>

#include "client/lib/decode.h"
#include "core/base/types.h"

namespace fascicle::client {

// The position of an image: the centre of voxel (i, j, k) is at origin + direction * (spacing times (i, j, k)).
struct ImagePlace {
  std::array<int, 3> size = {0, 0, 0};
  Vec3 spacing = Vec3::Ones();  // [m]
  Vec3 origin = Vec3::Zero();   // [m]
  Mat3 direction = Mat3::Identity();
};

// Assigns `label` to the voxels of an image whose centres are inside of a body with the given positions [m]. `labels`:
// one for each voxel, i fastest.
void AddLabels(const BodyShape& shape, const std::vector<Vec3>& positions, const ImagePlace& place, std::uint8_t label,
               std::vector<std::uint8_t>& labels);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_RENDER_BODY_LABELS_H_
