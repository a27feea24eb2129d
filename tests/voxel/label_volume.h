#ifndef FASCICLE_TESTS_VOXEL_LABEL_VOLUME_H_
#define FASCICLE_TESTS_VOXEL_LABEL_VOLUME_H_

#include <zlib.h>

#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

#include "core/geometry/voxel_grid.h"

namespace fascicle::testing {

inline std::string LabelVolumePath() {
  const char* folder = std::getenv("FASCICLE_DATA");
  return std::string(folder != nullptr ? folder : FASCICLE_ROOT "/../shared/data") +
         "/voxel_labels/upper_arm_biceps1_triceps2_1mm.mha";
}

// The voxels of one label of a compressed MetaImage of bytes, 1 mm [m], just enough of the format for that one file;
// none when it is not there.
inline std::optional<VoxelGrid> ReadLabel(const std::string& path, std::uint8_t label) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  GridIndex size = {};
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string key, equals;
    words >> key >> equals;
    if (key == "DimSize") words >> size[0] >> size[1] >> size[2];
    if (key == "ElementDataFile") break;
  }
  VoxelGrid grid = MakeVoxelGrid(size, Vec3::Constant(1e-3));
  std::ostringstream rest;
  rest << file.rdbuf();
  const std::string packed = rest.str();
  uLongf bytes = grid.material.size();
  if (uncompress(grid.material.data(), &bytes, reinterpret_cast<const Bytef*>(packed.data()), packed.size()) != Z_OK)
    return std::nullopt;
  for (std::uint8_t& material : grid.material) material = material == label ? 1 : 0;
  return grid;
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_VOXEL_LABEL_VOLUME_H_
