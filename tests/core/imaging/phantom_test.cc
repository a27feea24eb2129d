// The arm with known anatomy: its properties, and how accurately its muscle is segmented.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "core/imaging/arm_phantom.h"
#include "core/imaging/image_stage.h"
#include "core/imaging/masks.h"

namespace fascicle::testing {
namespace {

// The default settings, made once.
const ArmPhantom& Arm() {
  static const ArmPhantom arm = MakeArmPhantom({});
  return arm;
}

VoxelGrid TruthOf(const ArmPhantom& arm, const std::vector<ArmTissue>& tissues) {
  std::vector<std::uint8_t> material;
  for (const ArmTissue tissue : arm.truth) {
    material.push_back(std::find(tissues.begin(), tissues.end(), tissue) != tissues.end() ? 1 : 0);
  }
  return MakeVoxelGrid(arm.image, std::move(material));
}

std::optional<StagedImage> RunStage(const VolumeImage& image, const ImageStage& stage, int threads = 1) {
  ThreadTeam team(threads);
  Problems problems;
  CheckImageStage(stage, problems);
  std::optional<StagedImage> staged;
  if (problems.empty()) staged = RunImageStage(image, stage, team, problems);
  EXPECT_TRUE(staged) << problems.ToString();
  return staged;
}

// As a user would: filter the noise, put a seed into the muscle, open thin bridges.
ImageStage AnconeusStage(ClassMethod method) {
  ImageStage stage;
  stage.filters = {WaveletFilter{}};
  Classification choice;
  choice.method = method;
  stage.choice = choice;
  stage.seeds = {ArmPhantomSeed()};
  stage.cleaning.opening = 0.6e-3;
  stage.cleaning.keep = KeptParts::kSeeds;
  return stage;
}

TEST(ArmPhantom, IsTheSizeOfThePapersAnconeus) {
  EXPECT_EQ(Arm().image.size, (GridIndex{140, 220, 71}));
  std::array<std::int64_t, 7> voxels = {};
  for (const ArmTissue tissue : Arm().truth) ++voxels[static_cast<int>(tissue)];
  // [Zhu, Chen & Kaufman 1998, Table 1]: 116,630.
  EXPECT_NEAR(static_cast<double>(voxels[4]), 116630, 0.02 * 116630);
  for (const std::int64_t count : voxels) EXPECT_GT(count, 20000);
  const GridIndex seed = Arm().image.VoxelAt(ArmPhantomSeed());
  EXPECT_EQ(Arm().truth[Arm().image.IndexOf(seed)], ArmTissue::kAnconeus);
}

TEST(ArmPhantom, IsTheSameForTheSameSeed) {
  EXPECT_EQ(MakeArmPhantom({}).image.values, Arm().image.values);
  ArmPhantomSettings other;
  other.seed = 2;
  EXPECT_NE(MakeArmPhantom(other).image.values, Arm().image.values);
}

TEST(ArmPhantom, HasTheNoiseThatIsStated) {
  ThreadTeam team(1);
  // Edges increase the estimate.
  EXPECT_NEAR(EstimateNoise(Arm().image, team), 50, 8);
  ArmPhantomSettings settings;
  settings.noise = 0;
  const ArmPhantom clean = MakeArmPhantom(settings);
  double sum = 0, squares = 0, count = 0;
  for (std::size_t v = 0; v < clean.truth.size(); ++v) {
    if (clean.truth[v] != ArmTissue::kAnconeus) continue;
    const double noise = Arm().image.values[v] - clean.image.values[v];
    sum += noise;
    squares += noise * noise;
    ++count;
  }
  EXPECT_NEAR(std::sqrt(squares / count), 50, 1);
  // Rician noise brightens slightly, by deviation^2 / (2 signal) [Gudbjartsson and Patz 1995].
  EXPECT_NEAR(sum / count, 50.0 * 50 / (2 * 380), 1);
}

TEST(ArmPhantom, RefusesWhatIsNoNoise) {
  Problems problems;
  CheckArmPhantom({-0.1, 0.7, 1}, problems);
  EXPECT_EQ(problems.count(), 2u);
  Problems none;
  CheckArmPhantom({}, none);
  EXPECT_TRUE(none.empty());
}

TEST(ArmPhantom, TheAnconeusIsFound) {
  const VoxelGrid truth = TruthOf(Arm(), {ArmTissue::kAnconeus});
  for (const ClassMethod method : {ClassMethod::kFuzzyMeans, ClassMethod::kOtsu}) {
    const auto staged = RunStage(Arm().image, AnconeusStage(method));
    ASSERT_TRUE(staged);
    EXPECT_GE(DiceOverlap(staged->body, truth), 0.95);
    EXPECT_EQ(staged->wanted_class, 1);
    EXPECT_NEAR(staged->body_statistics.volume, staged->body_statistics.voxels * 1.25e-10, 1e-12);
    // The same voxels, cropped.
    EXPECT_LT(staged->grid.voxels(), staged->body.voxels());
    EXPECT_EQ(std::count(staged->grid.material.begin(), staged->grid.material.end(), 1),
              staged->body_statistics.voxels);
  }
}

TEST(ArmPhantom, AllMusclesAreFound) {
  ImageStage stage = AnconeusStage(ClassMethod::kFuzzyMeans);
  stage.cleaning.keep = KeptParts::kAll;
  stage.cleaning.opening = 1.1e-3;
  const auto staged = RunStage(Arm().image, stage);
  ASSERT_TRUE(staged);
  EXPECT_GE(DiceOverlap(staged->body, TruthOf(Arm(), {ArmTissue::kMuscle, ArmTissue::kAnconeus})), 0.95);
}

// Where noise hides the classes, filters recover them.
TEST(ArmPhantom, FiltersHelpAgainstStrongNoise) {
  ArmPhantomSettings settings;
  settings.noise = 0.15;
  const ArmPhantom noisy = MakeArmPhantom(settings);
  const VoxelGrid truth = TruthOf(noisy, {ArmTissue::kAnconeus});
  ImageStage stage = AnconeusStage(ClassMethod::kFuzzyMeans);
  const auto filtered = RunStage(noisy.image, stage);
  ASSERT_TRUE(filtered);
  EXPECT_GE(DiceOverlap(filtered->body, truth), 0.95);
  stage.filters.clear();
  stage.seeds.clear();
  Classification choice;
  choice.wanted_class = 1;
  stage.choice = choice;
  stage.cleaning = {0, KeptParts::kLargest, true};
  const auto raw = RunStage(noisy.image, stage);
  ASSERT_TRUE(raw);
  EXPECT_LT(DiceOverlap(raw->body, truth), 0.9);
}

TEST(ArmPhantom, TheSameForAnyNumberOfThreads) {
  ImageStage stage = AnconeusStage(ClassMethod::kFuzzyMeans);
  stage.region = VoxelBox{{60, 60, 10}, {70, 120, 40}};
  const auto one = RunStage(Arm().image, stage, 1), three = RunStage(Arm().image, stage, 3);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(one->body.material, three->body.material);
  EXPECT_EQ(one->membership, three->membership);
  EXPECT_EQ(one->filtered.values, three->filtered.values);
  EXPECT_EQ(one->centres, three->centres);
}

// [Zhu, Chen & Kaufman 1998, Table 1]: our muscle is a different one of that size, so that levels with many voxels have
// similar counts.
TEST(ArmPhantom, LevelsAreAsThePapersTable) {
  const auto staged = RunStage(Arm().image, AnconeusStage(ClassMethod::kFuzzyMeans));
  ASSERT_TRUE(staged);
  const std::vector<VoxelLevel> levels = MakeHierarchy(staged->grid, 0.5, 5);
  ASSERT_EQ(levels.size(), 5u);
  constexpr double kPhantomVoxels[] = {116630, 14578, 1840}, kNodes[] = {128924, 17723, 2664};
  for (int l = 0; l < 3; ++l) {
    EXPECT_NEAR(static_cast<double>(levels[l].voxels), kPhantomVoxels[l], 0.1 * kPhantomVoxels[l]) << l;
    EXPECT_NEAR(static_cast<double>(levels[l].nodes), kNodes[l], 0.1 * kNodes[l]) << l;
  }
}

}  // namespace
}  // namespace fascicle::testing
