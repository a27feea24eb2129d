#ifndef FASCICLE_TESTS_SUPPORT_LABEL_VOLUME_H_
#define FASCICLE_TESTS_SUPPORT_LABEL_VOLUME_H_

#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/imaging/volume_reader.h"
#include "tests/support/paths.h"

namespace fascicle::testing {

inline std::string LabelVolumePath() { return DataFolder() / "voxel_labels/upper_arm_biceps1_triceps2_1mm.mha"; }

// The voxels of one label of an image; none if it cannot be read.
inline std::optional<VoxelGrid> ReadLabel(const std::string& path, std::uint8_t label) {
  Problems problems;
  const std::optional<VolumeImage> image = ReadVolumeFiles({path}, {}, problems);
  if (!image) return std::nullopt;
  std::vector<std::uint8_t> material;
  for (const float value : image->values) material.push_back(value == label ? 1 : 0);
  return MakeVoxelGrid(*image, std::move(material));
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_LABEL_VOLUME_H_
