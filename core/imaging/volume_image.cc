#include "core/imaging/volume_image.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/stop.h"

namespace fascicle {
namespace {

// Position of a voxel centre of the resampled image between two centres of the original, along one axis.
struct Between {
  std::int32_t low, high;
  double weight;  // weight of `high`, in [0, 1]
};

// Offset of the first centre from that of the original image, along one axis: both images have the same midpoint.
double FirstCentre(std::int32_t from_size, double from_spacing, std::int32_t size, double spacing) {
  return 0.5 * (from_size * from_spacing - size * spacing) + 0.5 * (spacing - from_spacing);
}

std::vector<Between> Places(std::int32_t from_size, double from_spacing, std::int32_t size, double spacing) {
  std::vector<Between> places(size);
  const double first = FirstCentre(from_size, from_spacing, size, spacing);
  for (std::int32_t i = 0; i < size; ++i) {
    const double at = std::clamp((first + i * spacing) / from_spacing, 0.0, from_size - 1.0);
    const auto low = static_cast<std::int32_t>(at);
    places[i] = {low, std::min(low + 1, from_size - 1), at - low};
  }
  return places;
}

}  // namespace

GridIndex VolumeImage::VoxelAt(const Vec3& point) const {
  const Vec3 place = (direction.inverse() * (point - origin)).cwiseQuotient(spacing);
  constexpr double kFar = 1e9;
  GridIndex at;
  for (int axis = 0; axis < 3; ++axis) {
    at[axis] = static_cast<std::int32_t>(std::clamp(std::floor(place[axis] + 0.5), -kFar, kFar));
  }
  return at;
}

VolumeImage Crop(const VolumeImage& image, const VoxelBox& box) {
  for (int axis = 0; axis < 3; ++axis) {
    FASCICLE_CHECK(box.first[axis] >= 0 && box.size[axis] > 0 && box.size[axis] <= image.size[axis] - box.first[axis],
                   "the box was not checked");
  }
  VolumeImage part = image;
  part.size = box.size;
  part.origin = image.CentreOf(box.first);
  part.values.clear();
  part.values.reserve(part.voxels());
  for (std::int32_t k = 0; k < box.size[2]; ++k) {
    for (std::int32_t j = 0; j < box.size[1]; ++j) {
      const auto row = image.values.begin() +
                       static_cast<std::ptrdiff_t>(image.IndexOf({box.first[0], box.first[1] + j, box.first[2] + k}));
      part.values.insert(part.values.end(), row, row + box.size[0]);
    }
  }
  return part;
}

GridIndex ResampledSize(const GridIndex& size, const Vec3& from, double spacing) {
  GridIndex resampled;
  for (int axis = 0; axis < 3; ++axis) {
    resampled[axis] = static_cast<std::int32_t>(std::clamp(std::round(size[axis] * from[axis] / spacing), 1.0, 2e9));
  }
  return resampled;
}

VolumeImage Resample(const VolumeImage& image, double spacing, Interpolation interpolation,
                     const std::stop_token& stop) {
  VolumeImage cubes;
  cubes.size = ResampledSize(image.size, image.spacing, spacing);
  cubes.spacing = Vec3::Constant(spacing);
  cubes.direction = image.direction;
  Vec3 first;
  std::array<std::vector<Between>, 3> places;
  for (int axis = 0; axis < 3; ++axis) {
    first[axis] = FirstCentre(image.size[axis], image.spacing[axis], cubes.size[axis], spacing);
    places[axis] = Places(image.size[axis], image.spacing[axis], cubes.size[axis], spacing);
    if (interpolation == Interpolation::kLinear) continue;
    for (Between& place : places[axis]) place.weight = place.weight < 0.5 ? 0 : 1;
  }
  cubes.origin = image.origin + image.direction * first;
  cubes.values.reserve(cubes.voxels());
  for (const Between& z : places[2]) {
    for (const Between& y : places[1]) {
      ThrowIfStopped(stop);
      const float* rows[4] = {
          &image.values[image.IndexOf({0, y.low, z.low})], &image.values[image.IndexOf({0, y.high, z.low})],
          &image.values[image.IndexOf({0, y.low, z.high})], &image.values[image.IndexOf({0, y.high, z.high})]};
      const double weights[4] = {(1 - y.weight) * (1 - z.weight), y.weight * (1 - z.weight), (1 - y.weight) * z.weight,
                                 y.weight * z.weight};
      for (const Between& x : places[0]) {
        double value = 0;
        for (int r = 0; r < 4; ++r) {
          value += weights[r] * ((1 - x.weight) * rows[r][x.low] + x.weight * rows[r][x.high]);
        }
        cubes.values.push_back(static_cast<float>(value));
      }
    }
  }
  return cubes;
}

VoxelGrid MakeVoxelGrid(const VolumeImage& image, std::vector<std::uint8_t> material) {
  FASCICLE_CHECK(material.size() == image.voxels(), "one material for each voxel");
  VoxelGrid grid;
  grid.size = image.size;
  grid.spacing = image.spacing;
  grid.direction = image.direction;
  grid.origin = image.origin - 0.5 * (image.direction * image.spacing);
  grid.material = std::move(material);
  return grid;
}

void MakeRightHanded(VoxelGrid& grid) {
  if (grid.direction.determinant() >= 0) return;
  const std::size_t layer = static_cast<std::size_t>(grid.size[0]) * grid.size[1];
  const auto turn = [&](auto& values) {
    for (std::int32_t low = 0, high = grid.size[2] - 1; low < high; ++low, --high) {
      std::swap_ranges(values.begin() + static_cast<std::ptrdiff_t>(low * layer),
                       values.begin() + static_cast<std::ptrdiff_t>((low + 1) * layer),
                       values.begin() + static_cast<std::ptrdiff_t>(high * layer));
    }
  };
  turn(grid.material);
  if (!grid.stiffness.empty()) turn(grid.stiffness);
  grid.origin = grid.CornerAt({0, 0, grid.size[2]});
  grid.direction.col(2) = -grid.direction.col(2);
}

VolumeImage MakeLabelImage(const VoxelGrid& grid) {
  VolumeImage image;
  image.size = grid.size;
  image.spacing = grid.spacing;
  image.direction = grid.direction;
  image.origin = grid.origin + 0.5 * (grid.direction * grid.spacing);
  image.values.assign(grid.material.begin(), grid.material.end());
  return image;
}

}  // namespace fascicle
