#ifndef FASCICLE_CLIENT_CLI_IMAGE_SCENE_H_
#define FASCICLE_CLIENT_CLI_IMAGE_SCENE_H_

#include <array>
#include <filesystem>
#include <string>

#include "client/cli/command.h"
#include "core/geometry/voxel_grid.h"
#include "core/imaging/volume_image.h"

namespace fascicle::client {

// Where the solid voxels of a grid are, in patient coordinates.
struct VoxelPlace {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  // box around them [m]
  Vec3 middle = Vec3::Zero();                    // their centroid [m]
  std::array<int, 3> middle_voxel = {0, 0, 0};   // of the grid, that contains the centroid
};

// Of a grid with at least one solid voxel.
VoxelPlace PlaceOf(const VoxelGrid& grid);

// "box ..." and "middle ..." in mm, two lines; and the same for programs [m].
void PrintPlace(const VoxelPlace& place);
Json PlaceJson(const VoxelPlace& place);

// Writes a scene with the body of a label image, which has been written: fixed at one end of its longest extent, and
// pulled at the other, in the unit and frame of the image. `level` is the number of times voxels are joined; labels are
// 1 to `label_count`.
void WriteImageScene(const std::filesystem::path& scene, const std::filesystem::path& labels, const VoxelPlace& place,
                     int label_count, int level);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_IMAGE_SCENE_H_
