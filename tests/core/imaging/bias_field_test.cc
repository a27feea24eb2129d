// A known bias field of a coil, and its estimate.
#include <gtest/gtest.h>

#include <cmath>

#include "core/imaging/arm_phantom.h"
#include "core/imaging/filters.h"

namespace fascicle::testing {
namespace {

constexpr double kBias = 0.4;

// The variation of one tissue over the image: the relative deviation of block means from the tissue's mean. Blocks
// average the noise.
double Variation(const VolumeImage& image, const std::vector<ArmTissue>& truth, ArmTissue tissue) {
  constexpr int kBlock = 10;
  const int ni = image.size[0] / kBlock + 1, nj = image.size[1] / kBlock + 1, nk = image.size[2] / kBlock + 1;
  std::vector<double> sums(static_cast<std::size_t>(ni) * nj * nk), counts(sums.size());
  double sum = 0, count = 0;
  for (std::size_t v = 0; v < truth.size(); ++v) {
    if (truth[v] != tissue) continue;
    const auto i = static_cast<int>(v % image.size[0]), j = static_cast<int>(v / image.size[0] % image.size[1]);
    const auto k = static_cast<int>(v / image.size[0] / image.size[1]);
    const std::size_t block = i / kBlock + ni * (j / kBlock + static_cast<std::size_t>(nj) * (k / kBlock));
    sums[block] += static_cast<double>(image.values[v]);
    ++counts[block];
    sum += static_cast<double>(image.values[v]);
    ++count;
  }
  double squares = 0, blocks = 0;
  for (std::size_t b = 0; b < sums.size(); ++b) {
    if (counts[b] < 200) continue;
    squares += std::pow(sums[b] / counts[b] / (sum / count) - 1, 2);
    ++blocks;
  }
  return std::sqrt(squares / blocks);
}

TEST(BiasField, IsFoundAndTakenOut) {
  const ArmPhantom arm = MakeArmPhantom({.noise = 0.05, .bias = kBias});
  ThreadTeam team(1);
  const VolumeImage corrected = ApplyFilter(arm.image, BiasFieldFilter{}, team);
  for (const ArmTissue tissue : {ArmTissue::kMuscle, ArmTissue::kFat, ArmTissue::kAnconeus}) {
    const double before = Variation(arm.image, arm.truth, tissue), after = Variation(corrected, arm.truth, tissue);
    std::printf("tissue %d: values vary by %.3f before, %.3f after\n", static_cast<int>(tissue), before, after);
    EXPECT_LT(after, tissue == ArmTissue::kAnconeus ? 0.04 : 0.25 * before);
  }
  EXPECT_GT(Variation(arm.image, arm.truth, ArmTissue::kMuscle), 0.15);
}

// Without a bias field, nothing is corrected.
TEST(BiasField, LeavesAnEvenImageNearlyAsItIs) {
  const ArmPhantom arm = MakeArmPhantom({.noise = 0.05, .bias = 0});
  ThreadTeam team(1);
  const VolumeImage corrected = ApplyFilter(arm.image, BiasFieldFilter{}, team);
  double largest = 0;
  for (std::size_t v = 0; v < arm.image.voxels(); ++v) {
    if (arm.truth[v] != ArmTissue::kMuscle || arm.image.values[v] <= 0) continue;
    largest = std::max(largest, std::abs(static_cast<double>(corrected.values[v] / arm.image.values[v]) - 1));
  }
  EXPECT_LT(largest, 0.08);
}

TEST(BiasField, ValuesOfZeroAndBelowStay) {
  ArmPhantom arm = MakeArmPhantom({});
  arm.image.values[0] = 0;
  arm.image.values[1] = -5;
  ThreadTeam team(1);
  const VolumeImage corrected = ApplyFilter(arm.image, BiasFieldFilter{.refinements = 1, .iterations = 3}, team);
  EXPECT_EQ(corrected.values[0], 0);
  EXPECT_EQ(corrected.values[1], -5);
  EXPECT_EQ(corrected.size, arm.image.size);
  EXPECT_EQ(corrected.spacing, arm.image.spacing);
}

}  // namespace
}  // namespace fascicle::testing
