#ifndef FASCICLE_CORE_IMAGING_VOLUME_IMAGE_H_
#define FASCICLE_CORE_IMAGING_VOLUME_IMAGE_H_

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "core/geometry/voxel_grid.h"

namespace fascicle {

// A volume with one number per voxel: a scan, or its labels. Plain data.
struct VolumeImage {
  GridIndex size = {0, 0, 0};   // voxels along i, j, k
  Vec3 spacing = Vec3::Ones();  // edge lengths of a voxel [m]
  // The centre of voxel (i, j, k) is at origin + direction * (spacing times (i, j, k)) [m], in DICOM's patient
  // coordinates: x to the left, y to the back, z to the head.
  Vec3 origin = Vec3::Zero();
  Mat3 direction = Mat3::Identity();  // columns: unit vectors along i, j, k
  // Value of each voxel, i fastest, then j, in the file's own unit. Integers are exact up to 2^24.
  std::vector<float> values;
  // What its reader decided where the file left something open or contradicted itself, one sentence each.
  std::vector<std::string> notes;

  std::size_t voxels() const { return static_cast<std::size_t>(size[0]) * size[1] * size[2]; }
  std::size_t IndexOf(const GridIndex& at) const {
    return static_cast<std::size_t>(at[0]) +
           static_cast<std::size_t>(size[0]) * (at[1] + static_cast<std::size_t>(size[1]) * at[2]);
  }
  bool Contains(const GridIndex& at) const {
    return at[0] >= 0 && at[1] >= 0 && at[2] >= 0 && at[0] < size[0] && at[1] < size[1] && at[2] < size[2];
  }
  double voxel_volume() const { return spacing.prod(); }  // [m^3]
  Vec3 CentreOf(const GridIndex& at) const {
    return origin + direction * spacing.cwiseProduct(Vec3(at[0], at[1], at[2]));
  }
  // The voxel that contains a point [m]; may be outside of the image.
  GridIndex VoxelAt(const Vec3& point) const;
};

// A box of voxels [first, first + size).
struct VoxelBox {
  GridIndex first = {0, 0, 0};
  GridIndex size = {0, 0, 0};

  bool operator==(const VoxelBox&) const = default;
};

// The part of an image in a box, which must be inside of the image.
VolumeImage Crop(const VolumeImage& image, const VoxelBox& box);

// How to evaluate values between the centres of voxels: trilinear, or nearest voxel for labels. Beyond the outermost
// centres the values are constant. (Resampling: cubes of the given spacing [m] fill the same box up to half a cube.)
// Throws Stopped after a stop request.
enum class Interpolation { kLinear, kNearest };
VolumeImage Resample(const VolumeImage& image, double spacing, Interpolation interpolation,
                     const std::stop_token& stop = {});
// The size of a resampled image.
GridIndex ResampledSize(const GridIndex& size, const Vec3& from, double spacing);

// A grid at the image's position with the given `material` of each voxel (0: empty), in the image's order.
VoxelGrid MakeVoxelGrid(const VolumeImage& image, std::vector<std::uint8_t> material);
// Images may have left-handed axes; simulated grids must not. Reverses such a grid along k; each voxel stays where it
// is in space.
void MakeRightHanded(VoxelGrid& grid);
// The materials of a grid as an image.
VolumeImage MakeLabelImage(const VoxelGrid& grid);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_VOLUME_IMAGE_H_
