// Positions of voxels, and operations that preserve them.
#include <gtest/gtest.h>

#include "volume_samples.h"

namespace fascicle::testing {
namespace {

TEST(VolumeImage, FindsTheVoxelOfAPoint) {
  const VolumeImage image = ObliqueImage();
  const GridIndex at = {3, 4, 1};
  EXPECT_EQ(image.VoxelAt(image.CentreOf(at)), at);
  const Vec3 aside = image.direction * Vec3(0.49, -0.49, 0.49).cwiseProduct(image.spacing);
  EXPECT_EQ(image.VoxelAt(image.CentreOf(at) + aside), at);
  EXPECT_EQ(image.VoxelAt(image.CentreOf(at) + 2.1 * aside), (GridIndex{4, 3, 2}));
  EXPECT_FALSE(image.Contains(image.VoxelAt(image.CentreOf({-1, 0, 0}))));
  EXPECT_FALSE(image.Contains(image.VoxelAt(Vec3::Constant(1e300))));
}

TEST(VolumeImage, CroppedVoxelsStayWhereTheyWere) {
  const VolumeImage image = ObliqueImage();
  const VolumeImage part = Crop(image, {{2, 1, 1}, {3, 4, 2}});
  EXPECT_EQ(part.voxels(), part.values.size());
  EXPECT_LT((part.CentreOf({1, 2, 1}) - image.CentreOf({3, 3, 2})).norm(), 1e-15);
  EXPECT_EQ(part.values[part.IndexOf({1, 2, 1})], image.values[image.IndexOf({3, 3, 2})]);
}

// A linear function is trilinear between centres, so that resampling reproduces it; beyond them it is constant.
TEST(VolumeImage, ResamplesLinearFunctionsExactly) {
  VolumeImage image = ObliqueImage();
  image.size = {20, 12, 8};
  image.values.resize(image.voxels());
  const Vec3 slope(300, -200, 100);
  for (std::int32_t k = 0; k < 8; ++k) {
    for (std::int32_t j = 0; j < 12; ++j) {
      for (std::int32_t i = 0; i < 20; ++i) {
        image.values[image.IndexOf({i, j, k})] = static_cast<float>(slope.dot(image.CentreOf({i, j, k})));
      }
    }
  }
  const VolumeImage cubes = Resample(image, 1e-3, Interpolation::kLinear);
  EXPECT_EQ(cubes.size, (GridIndex{14, 15, 24}));
  EXPECT_EQ(cubes.size, ResampledSize(image.size, image.spacing, 1e-3));
  for (std::int32_t k = 2; k < 22; ++k) {
    for (std::int32_t j = 1; j < 14; ++j) {
      for (std::int32_t i = 1; i < 13; ++i) {
        ASSERT_NEAR(cubes.values[cubes.IndexOf({i, j, k})], slope.dot(cubes.CentreOf({i, j, k})), 1e-4);
      }
    }
  }
}

TEST(VolumeImage, ResampledLabelsAreThoseOfTheNearestVoxel) {
  const VolumeImage image = ObliqueImage();
  // None of their centres is midway between two of the image.
  const VolumeImage cubes = Resample(image, 0.33e-3, Interpolation::kNearest);
  for (std::int32_t k = 0; k < cubes.size[2]; ++k) {
    for (std::int32_t j = 0; j < cubes.size[1]; ++j) {
      for (std::int32_t i = 0; i < cubes.size[0]; ++i) {
        GridIndex nearest = image.VoxelAt(cubes.CentreOf({i, j, k}));
        for (int axis = 0; axis < 3; ++axis) nearest[axis] = std::clamp(nearest[axis], 0, image.size[axis] - 1);
        ASSERT_EQ(cubes.values[cubes.IndexOf({i, j, k})], image.values[image.IndexOf(nearest)]);
      }
    }
  }
}

TEST(VolumeImage, GridsBeginHalfAVoxelBefore) {
  const VolumeImage image = ObliqueImage();
  std::vector<std::uint8_t> material(image.voxels(), 0);
  material[image.IndexOf({1, 2, 3})] = 7;
  const VoxelGrid grid = MakeVoxelGrid(image, material);
  const Vec3 middle = 0.5 * (grid.CornerAt({1, 2, 3}) + grid.CornerAt({2, 3, 4}));
  EXPECT_LT((middle - image.CentreOf({1, 2, 3})).norm(), 1e-15);
  const VolumeImage labels = MakeLabelImage(grid);
  EXPECT_LT((labels.origin - image.origin).norm(), 1e-15);
  EXPECT_EQ(labels.values[labels.IndexOf({1, 2, 3})], 7);
}

TEST(VolumeImage, LeftHandedGridsAreTurnedRound) {
  VolumeImage image = ObliqueImage();
  image.direction.col(0) = -image.direction.col(0);
  std::vector<std::uint8_t> material(image.voxels(), 0);
  material[image.IndexOf({1, 2, 0})] = 7;
  VoxelGrid grid = MakeVoxelGrid(image, material);
  MakeRightHanded(grid);
  EXPECT_NEAR(grid.direction.determinant(), 1, 1e-12);
  EXPECT_EQ(grid.MaterialAt({1, 2, 3}), 7);
  const Vec3 middle = 0.5 * (grid.CornerAt({1, 2, 3}) + grid.CornerAt({2, 3, 4}));
  EXPECT_LT((middle - image.CentreOf({1, 2, 0})).norm(), 1e-15);
  const VoxelGrid before = grid;
  MakeRightHanded(grid);
  EXPECT_EQ(grid.material, before.material);
}

}  // namespace
}  // namespace fascicle::testing
