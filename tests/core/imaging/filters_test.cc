// Filters against explicit sums, closed forms and known noise.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/imaging/filters.h"

namespace fascicle::testing {
namespace {

VolumeImage Empty(const GridIndex& size, const Vec3& spacing = Vec3::Constant(1e-3)) {
  VolumeImage image;
  image.size = size;
  image.spacing = spacing;
  image.values.assign(image.voxels(), 0);
  return image;
}

VolumeImage Noise(const GridIndex& size, double deviation) {
  VolumeImage image = Empty(size);
  std::mt19937 random(5);
  std::normal_distribution<double> normal(500, deviation);
  for (float& value : image.values) value = static_cast<float>(normal(random));
  return image;
}

double DeviationFrom(const VolumeImage& image, const VolumeImage& truth) {
  double sum = 0;
  for (std::size_t v = 0; v < image.voxels(); ++v) sum += std::pow(image.values[v] - truth.values[v], 2);
  return std::sqrt(sum / static_cast<double>(image.voxels()));
}

TEST(Filters, TheSameBitsForAnyNumberOfThreads) {
  VolumeImage image = Noise({33, 20, 9}, 40);
  image.spacing = {1e-3, 1.5e-3, 4e-3};
  ThreadTeam one(1), three(3);
  for (const ImageFilter& filter : {ImageFilter(GaussianFilter{2e-3}), ImageFilter(CurvatureFilter{}),
                                    ImageFilter(WaveletFilter{}), ImageFilter(BiasFieldFilter{})}) {
    const VolumeImage filtered = ApplyFilter(image, filter, one);
    EXPECT_EQ(filtered.values, ApplyFilter(image, filter, three).values) << filter.index();
    EXPECT_EQ(filtered.spacing, image.spacing);
    EXPECT_NE(filtered.values, image.values);
  }
}

TEST(Filters, AnythingGoesWithImagesOfOneVoxelAcross) {
  ThreadTeam team(1);
  for (const GridIndex& size : {GridIndex{1, 1, 1}, GridIndex{5, 1, 1}, GridIndex{2, 3, 1}, GridIndex{1, 2, 9}}) {
    const VolumeImage image = Noise(size, 10);
    for (const ImageFilter& filter : {ImageFilter(GaussianFilter{}), ImageFilter(CurvatureFilter{}),
                                      ImageFilter(WaveletFilter{8, 3}), ImageFilter(BiasFieldFilter{})}) {
      const VolumeImage filtered = ApplyFilter(image, filter, team);
      ASSERT_EQ(filtered.values.size(), image.values.size());
      for (const float value : filtered.values) EXPECT_TRUE(std::isfinite(value));
    }
  }
}

// The variance of a blurred voxel along each axis is that of the Gaussian [m^2] for any spacing; this also holds for
// the discrete Gaussian [Lindeberg 1994].
TEST(Filters, HeedStopRequests) {
  const VolumeImage image = Noise({33, 20, 9}, 40);
  std::stop_source source;
  source.request_stop();
  ThreadTeam team(2, source.get_token());
  for (const ImageFilter& filter : {ImageFilter(GaussianFilter{2e-3}), ImageFilter(CurvatureFilter{}),
                                    ImageFilter(WaveletFilter{}), ImageFilter(BiasFieldFilter{})}) {
    EXPECT_THROW(ApplyFilter(image, filter, team), Stopped) << filter.index();
  }
}

TEST(Gaussian, HasTheVarianceThatIsAskedForInMetres) {
  VolumeImage image = Empty({41, 31, 15}, {0.5e-3, 0.8e-3, 2e-3});
  const GridIndex middle = {20, 15, 7};
  image.values[image.IndexOf(middle)] = 1000;
  ThreadTeam team(1);
  const VolumeImage blurred = ApplyFilter(image, GaussianFilter{1.5e-3}, team);
  double total = 0;
  Vec3 variance = Vec3::Zero();
  std::size_t v = 0;
  for (std::int32_t k = 0; k < 15; ++k) {
    for (std::int32_t j = 0; j < 31; ++j) {
      for (std::int32_t i = 0; i < 41; ++i, ++v) {
        const Vec3 away = blurred.CentreOf({i, j, k}) - blurred.CentreOf(middle);
        total += blurred.values[v];
        variance += blurred.values[v] * away.cwiseAbs2();
      }
    }
  }
  EXPECT_NEAR(total, 1000, 0.5);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(variance[axis] / total, 1.5e-3 * 1.5e-3, 0.01 * 1.5e-3 * 1.5e-3);
}

TEST(Curvature, SmoothsPlainsAndKeepsEdges) {
  VolumeImage truth = Empty({40, 24, 24});
  for (std::size_t v = 0; v < truth.voxels(); ++v) truth.values[v] = v % 40 < 20 ? 200 : 1000;
  VolumeImage image = truth;
  const VolumeImage noise = Noise(image.size, 40);
  for (std::size_t v = 0; v < image.voxels(); ++v) image.values[v] += noise.values[v] - 500;
  ThreadTeam team(1);
  const VolumeImage diffused = ApplyFilter(image, CurvatureFilter{}, team);
  EXPECT_LT(DeviationFrom(diffused, truth), 0.7 * DeviationFrom(image, truth));
  EXPECT_LT(DeviationFrom(diffused, truth), 0.5 * DeviationFrom(ApplyFilter(image, GaussianFilter{1e-3}, team), truth));
}

TEST(Wavelet, NothingIsLostWithoutAThreshold) {
  const VolumeImage image = Noise({17, 12, 7}, 100);
  ThreadTeam team(2);
  EXPECT_EQ(ApplyFilter(image, WaveletFilter{4, 0}, team).values, image.values);
  // Values far above the noise stay, except for the shrinkage t^2 / w of a coefficient w.
  const VolumeImage barely = ApplyFilter(image, WaveletFilter{4, 1e-4}, team);
  EXPECT_LT(DeviationFrom(barely, image), 1e-3);
}

// Removing all coefficients leaves the smooth residual: the image blurred by splines with holes, written out here with
// mirrored sides.
TEST(Wavelet, ScalesAreBlursBySplinesWithHoles) {
  const VolumeImage image = Noise({9, 7, 6}, 100);
  ThreadTeam team(1);
  const VolumeImage smooth = ApplyFilter(image, WaveletFilter{2, 1e6}, team);
  const auto mirrored = [](int at, int size) {
    while (at < 0 || at >= size) at = at < 0 ? -at : 2 * (size - 1) - at;
    return at;
  };
  VolumeImage plain = image;
  constexpr double kSpline[5] = {1 / 16.0, 4 / 16.0, 6 / 16.0, 4 / 16.0, 1 / 16.0};
  for (const int step : {1, 2}) {
    const VolumeImage from = plain;
    for (int k = 0; k < 6; ++k) {
      for (int j = 0; j < 7; ++j) {
        for (int i = 0; i < 9; ++i) {
          double sum = 0;
          for (int t = 0; t < 125; ++t) {
            const int a = t % 5, b = t / 5 % 5, c = t / 25;
            const GridIndex at = {mirrored(i + (a - 2) * step, 9), mirrored(j + (b - 2) * step, 7),
                                  mirrored(k + (c - 2) * step, 6)};
            sum += kSpline[a] * kSpline[b] * kSpline[c] * from.values[from.IndexOf(at)];
          }
          plain.values[plain.IndexOf({i, j, k})] = static_cast<float>(sum);
        }
      }
    }
  }
  EXPECT_LT(DeviationFrom(smooth, plain), 2e-4);
}

TEST(Wavelet, EstimatesTheNoise) {
  ThreadTeam team(1);
  for (const double deviation : {5.0, 50.0}) {
    EXPECT_NEAR(EstimateNoise(Noise({64, 64, 32}, deviation), team), deviation, 0.03 * deviation);
    EXPECT_NEAR(EstimateNoise(Noise({256, 256, 1}, deviation), team), deviation, 0.03 * deviation);
  }
  // Masked background is ignored.
  VolumeImage image = Noise({64, 64, 64}, 50);
  std::fill(image.values.begin(), image.values.begin() + 64 * 64 * 32, 0.0F);
  EXPECT_NEAR(EstimateNoise(image, team), 50, 5);
  EXPECT_EQ(EstimateNoise(Empty({8, 8, 8}), team), 0);
}

// Flat regions lose nearly all of their noise. Beside a step of 800 the finest coefficient is 5/16 of it, w = 250, and
// shrinkage removes t^2 / w with t = 3 * 40 on either side: 115. A Gaussian of one voxel would remove more than half of
// the step.
TEST(Wavelet, NoiseFallsAndEdgesStay) {
  VolumeImage truth = Empty({64, 48, 32});
  for (std::size_t v = 0; v < truth.voxels(); ++v) truth.values[v] = v % 64 < 32 ? 200 : 1000;
  VolumeImage image = truth;
  const VolumeImage noise = Noise(image.size, 40);
  for (std::size_t v = 0; v < image.voxels(); ++v) image.values[v] += noise.values[v] - 500;
  ThreadTeam team(1);
  const VolumeImage filtered = ApplyFilter(image, WaveletFilter{}, team);
  double before = 0, after = 0, low = 0, high = 0;
  int plain = 0, side = 0;
  for (std::size_t v = 0; v < image.voxels(); ++v) {
    const auto i = static_cast<int>(v % 64);
    if (i < 16 || i >= 48) {
      before += std::pow(image.values[v] - truth.values[v], 2);
      after += std::pow(filtered.values[v] - truth.values[v], 2);
      ++plain;
    }
    if (i == 31) low += filtered.values[v];
    if (i == 32) high += filtered.values[v];
    side += i == 31 ? 1 : 0;
  }
  EXPECT_NEAR(std::sqrt(before / plain), 40, 1);
  EXPECT_LT(std::sqrt(after / plain), 10);
  EXPECT_GT((high - low) / side, 800 - 2 * 120 * 120 / 250.0 - 20);
}

}  // namespace
}  // namespace fascicle::testing
