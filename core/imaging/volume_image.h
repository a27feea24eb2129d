#ifndef FASCICLE_CORE_IMAGING_VOLUME_IMAGE_H_
#define FASCICLE_CORE_IMAGING_VOLUME_IMAGE_H_

#include <cstdint>
#include <vector>

#include "core/geometry/voxel_grid.h"

namespace fascicle {

// A volume of one number a voxel: a scan, or the labels of one. Plain data.
struct VolumeImage {
  GridIndex size = {0, 0, 0};   // voxels along i, j, k
  Vec3 spacing = Vec3::Ones();  // of a voxel [m]
  // The centre of voxel (i, j, k) is at origin + direction * (spacing times (i, j, k)) [m], in the patient's frame of
  // DICOM: x to the left, y to the back, z to the head.
  Vec3 origin = Vec3::Zero();
  Mat3 direction = Mat3::Identity();  // columns: unit vectors along i, j, k
  // Of each voxel, i fastest, then j. In the file's own unit; whole numbers are exact up to 2^24.
  std::vector<float> values;

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
  // The voxel that holds a point [m], which may be outside of the image.
  GridIndex VoxelAt(const Vec3& point) const;
};

// A box of voxels [first, first + size).
struct VoxelBox {
  GridIndex first = {0, 0, 0};
  GridIndex size = {0, 0, 0};

  bool operator==(const VoxelBox&) const = default;
};

// The part of an image in a box, which must lie inside of it.
VolumeImage Crop(const VolumeImage& image, const VoxelBox& box);

// The image in cubes of that spacing [m], which fill the same box up to half a cube: values between the centres of
// voxels are trilinear, or those of the nearest voxel for labels; beyond the outermost centres they stay the same.
enum class Interpolation { kLinear, kNearest };
VolumeImage Resample(const VolumeImage& image, double spacing, Interpolation interpolation);
// The size that the result has.
GridIndex ResampledSize(const GridIndex& size, const Vec3& from, double spacing);

// A grid in the image's place whose voxels are of `material` (one for each voxel, 0: empty), in the image's order.
VoxelGrid MakeVoxelGrid(const VolumeImage& image, std::vector<std::uint8_t> material);
// Images may have left-handed axes; what is simulated must not. Such a grid is turned round along k: each voxel stays
// where it is in space.
void MakeRightHanded(VoxelGrid& grid);
// The materials of a grid as an image.
VolumeImage MakeLabelImage(const VoxelGrid& grid);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_VOLUME_IMAGE_H_
