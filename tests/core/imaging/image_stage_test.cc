// The stage from an image to voxels: every member works, and problems are reported with their paths.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/stop.h"
#include "core/imaging/image_stage.h"

namespace fascicle::testing {
namespace {

using ::testing::_;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Two bright cubes of 4 voxels on a dark background; the lower half of the second is brighter; a hole in the first.
VolumeImage TwoCubes() {
  VolumeImage image;
  image.size = {14, 8, 8};
  image.spacing = {1e-3, 1e-3, 2e-3};
  image.origin = {5e-3, 0, 0};
  for (int k = 0; k < 8; ++k) {
    for (int j = 0; j < 8; ++j) {
      for (int i = 0; i < 14; ++i) {
        const bool inside = j >= 2 && j < 6 && k >= 2 && k < 6;
        const bool hole = i == 3 && j == 3 && k == 3;
        const bool first = inside && i >= 2 && i < 6 && !hole, second = inside && i >= 8 && i < 13;
        image.values.push_back(first ? 100 : second ? 200 : 0);
      }
    }
  }
  return image;
}

std::optional<StagedImage> RunStage(const VolumeImage& image, const ImageStage& stage, Problems& problems) {
  ThreadTeam team(1);
  CheckImageStage(stage, problems);
  return problems.empty() ? RunImageStage(image, stage, team, problems) : std::nullopt;
}

StagedImage Good(const ImageStage& stage, const VolumeImage& image = TwoCubes()) {
  Problems problems;
  std::optional<StagedImage> staged = RunStage(image, stage, problems);
  EXPECT_TRUE(staged) << problems.ToString();
  return staged.value_or(StagedImage());
}

ImageStage ClassStage(int wanted) {
  ImageStage stage;
  Classification choice;
  choice.wanted_class = wanted;
  stage.choice = choice;
  return stage;
}

TEST(ImageStage, TakesTheWantedClass) {
  for (const ClassMethod method : {ClassMethod::kFuzzyMeans, ClassMethod::kOtsu, ClassMethod::kGivenThresholds}) {
    ImageStage stage = ClassStage(1);
    auto& choice = std::get<Classification>(stage.choice);
    choice.method = method;
    if (method == ClassMethod::kGivenThresholds) choice.thresholds = {50, 150};
    const StagedImage staged = Good(stage);
    EXPECT_EQ(staged.statistics.size(), 3u);
    EXPECT_EQ(staged.statistics[1].voxels, 63);
    EXPECT_EQ(staged.statistics[2].voxels, 80);
    EXPECT_NEAR(staged.statistics[2].volume, 80 * 2e-9, 1e-15);
    EXPECT_EQ(staged.statistics[1].mean, 100);
    // The hole is filled, and counted.
    EXPECT_EQ(staged.body_statistics.voxels, 64);
    EXPECT_EQ(staged.body_statistics.lowest, 0);
    EXPECT_EQ(staged.grid.size, (GridIndex{4, 4, 4}));
    EXPECT_LT((staged.grid.origin - Vec3(6.5e-3, 1.5e-3, 3e-3)).norm(), 1e-15);
    EXPECT_EQ(staged.membership.empty(), method != ClassMethod::kFuzzyMeans);
    stage.cleaning.fill_holes = false;
    EXPECT_EQ(Good(stage).body_statistics.voxels, 63);
  }
}

TEST(ImageStage, SeedsTellTheClassAndThePart) {
  ImageStage stage;
  std::get<Classification>(stage.choice).classes = 2;
  stage.seeds = {TwoCubes().CentreOf({9, 3, 3})};
  stage.cleaning.keep = KeptParts::kSeeds;
  const StagedImage staged = Good(stage);
  EXPECT_EQ(staged.wanted_class, 1);
  EXPECT_EQ(staged.body_statistics.voxels, 80);
  stage.cleaning.keep = KeptParts::kAll;
  EXPECT_EQ(Good(stage).body_statistics.voxels, 144);
  stage.cleaning.keep = KeptParts::kLargest;
  EXPECT_EQ(Good(stage).body_statistics.voxels, 80);
}

TEST(ImageStage, LabelsAndMasks) {
  ImageStage stage;
  stage.choice = LabelChoice{{200, 100}};
  stage.cleaning.keep = KeptParts::kAll;
  const StagedImage staged = Good(stage);
  EXPECT_EQ(staged.statistics[0].voxels, 80);
  EXPECT_EQ(staged.statistics[1].voxels, 63);
  EXPECT_EQ(staged.body.MaterialAt({9, 3, 3}), 1);
  EXPECT_EQ(staged.body.MaterialAt({2, 3, 3}), 2);
  EXPECT_EQ(staged.body.MaterialAt({3, 3, 3}), 2) << "a hole is what is around it";
  stage.choice = LabelChoice{};
  EXPECT_EQ(Good(stage).body.MaterialAt({9, 3, 3}), 1);
  EXPECT_EQ(Good(stage).body_statistics.voxels, 144);
}

TEST(ImageStage, RegionAndResampling) {
  ImageStage stage;
  stage.choice = LabelChoice{};
  stage.region = VoxelBox{{7, 0, 0}, {7, 8, 8}};
  EXPECT_EQ(Good(stage).body_statistics.voxels, 80);
  stage.resample = 1e-3;
  const StagedImage staged = Good(stage);
  EXPECT_EQ(staged.image.size, (GridIndex{7, 8, 16}));
  EXPECT_EQ(staged.body_statistics.voxels, 160);
  EXPECT_NEAR(staged.body_statistics.volume, 80 * 2e-9, 1e-15);
}

TEST(ImageStage, Levels) {
  ImageStage stage = ClassStage(1);
  stage.level = 1;
  EXPECT_EQ(Good(stage).grid.size, (GridIndex{2, 2, 2}));
  EXPECT_EQ(Good(stage).grid.spacing, Vec3(2e-3, 2e-3, 4e-3));
  stage.level = 2;
  EXPECT_EQ(Good(stage).grid.voxels(), 1u);
}

TEST(ImageStage, GridsAreRightHanded) {
  VolumeImage image = TwoCubes();
  image.direction.col(1) = -image.direction.col(1);
  const StagedImage staged = Good(ClassStage(2), image);
  EXPECT_NEAR(staged.grid.direction.determinant(), 1, 1e-12);
  EXPECT_NEAR(staged.body.direction.determinant(), -1, 1e-12);
  // The centre of the cube does not move.
  const Vec3 middle = staged.grid.origin + 0.5 * staged.grid.direction *
                                               staged.grid.spacing.cwiseProduct(
                                                   Vec3(staged.grid.size[0], staged.grid.size[1], staged.grid.size[2]));
  EXPECT_LT((middle - 0.5 * (image.CentreOf({8, 2, 2}) + image.CentreOf({12, 5, 5}))).norm(), 1e-15);
}

TEST(ImageStage, ProgressRises) {
  double last = -1;
  ThreadTeam team(1);
  Problems problems;
  RunImageStage(TwoCubes(), ClassStage(1), team, problems, [&](double fraction, const char* stage) {
    EXPECT_GE(fraction, last);
    EXPECT_NE(stage, nullptr);
    last = fraction;
  });
  EXPECT_EQ(last, 1);
}

TEST(ImageStage, StopsAtEveryStage) {
  ImageStage stage = ClassStage(1);
  stage.filters = {WaveletFilter{}, GaussianFilter{}};
  stage.level = 1;
  std::vector<std::string> stages;
  ThreadTeam team(1);
  Problems problems;
  ASSERT_TRUE(
      RunImageStage(TwoCubes(), stage, team, problems, [&](double, const char* next) { stages.emplace_back(next); }));
  ASSERT_GT(stages.size(), 5u);
  for (std::size_t last = 0; last < stages.size(); ++last) {
    std::stop_source source;
    team.HeedStop(source.get_token());
    std::size_t told = 0;
    const auto stop_at_last = [&](double, const char* next) {
      EXPECT_EQ(next, stages[told]);
      if (told++ == last) source.request_stop();
    };
    EXPECT_THROW(RunImageStage(TwoCubes(), stage, team, problems, stop_at_last), Stopped) << stages[last];
    EXPECT_EQ(told, last + 1);
  }
  EXPECT_TRUE(problems.empty());
}

std::vector<std::string> PathsOf(const Problems& problems) {
  std::vector<std::string> paths;
  for (const Problem& problem : problems.kept()) paths.push_back(problem.path);
  return paths;
}

TEST(ImageStage, TellsAllMistakesAtOnce) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ImageStage stage;
  stage.region = VoxelBox{{-1, 0, 0}, {0, 1, 1}};
  stage.resample = nan;
  stage.filters = {GaussianFilter{0}, CurvatureFilter{0, nan}, WaveletFilter{9, -1}, BiasFieldFilter{6, 0}};
  Classification choice;
  choice.classes = 1;
  choice.fuzziness = 1;
  choice.least_membership = 2;
  choice.thresholds = {1};
  stage.choice = choice;
  stage.cleaning = {nan, KeptParts::kSeeds, true};
  stage.level = -1;
  stage.fraction = 0;
  Problems problems;
  CheckImageStage(stage, problems);
  EXPECT_THAT(PathsOf(problems),
              ElementsAre("region.first", "region.size", "resample", "filters[0].deviation", "filters[1].iterations",
                          "filters[1].conductance", "filters[2].scales", "filters[2].threshold",
                          "filters[3].refinements", "filters[3].iterations", "classification.classes",
                          "classification.fuzziness", "classification.least_membership", "classification.thresholds",
                          "classification.wanted_class", "cleaning.keep", "cleaning.opening", "level", "fraction"));
  choice = {};
  choice.method = ClassMethod::kGivenThresholds;
  choice.thresholds = {1, 1, nan};
  choice.wanted_class = 4;
  stage = {};
  stage.choice = choice;
  stage.seeds = {Vec3(0, nan, 0)};
  Problems more;
  CheckImageStage(stage, more);
  EXPECT_THAT(PathsOf(more), ElementsAre("classification.thresholds[1]", "classification.thresholds[2]",
                                         "classification.wanted_class", "seeds[0]"));
  stage = {};
  stage.choice = LabelChoice{{0, 2, 2}};
  stage.filters = {WaveletFilter{}};
  Problems labels;
  CheckImageStage(stage, labels);
  EXPECT_THAT(PathsOf(labels), ElementsAre("labels[0]", "labels[2]", "filters"));
}

// Programs store labels with scales and in floats.
TEST(ImageStage, AValueWithinAThousandthIsTheLabel) {
  VolumeImage image = TwoCubes();
  for (float& value : image.values) value = value == 100 ? 1.9992F : value == 200 ? 0.7F : 0;
  ImageStage stage;
  stage.choice = LabelChoice{{2}};
  stage.cleaning.fill_holes = false;
  const StagedImage staged = Good(stage, image);
  EXPECT_EQ(staged.statistics[0].voxels, 63);
  EXPECT_THAT(staged.notes, ElementsAre(HasSubstr("80 voxels have values that are no whole numbers, such as 0.7")));
  stage.choice = LabelChoice{{1}};
  Problems problems;
  EXPECT_FALSE(RunStage(image, stage, problems));
  EXPECT_THAT(problems.ToString(), HasSubstr("existing values: 0.7, 2; they are no labels"));
}

TEST(ImageStage, NotesOfTheImageAndBodiesOfUnusualSize) {
  VolumeImage image = TwoCubes();
  image.notes = {"said by the reader"};
  ImageStage stage;
  stage.choice = LabelChoice{{100}};
  EXPECT_THAT(Good(stage, image).notes, ElementsAre("said by the reader"));
  image.spacing *= 1000;  // the cube's edges are 4 m and 8 m
  EXPECT_THAT(Good(stage, image).notes, ElementsAre(_, HasSubstr("the body is 8e+03 mm long")));
  image.spacing *= 1e-5;
  EXPECT_THAT(Good(stage, image).notes, ElementsAre(_, HasSubstr("the body is 0.08 mm long")));
}

// Problems that only the image reveals.
TEST(ImageStage, TellsWhatDoesNotFitTheImage) {
  const auto refusal = [](const ImageStage& stage, const VolumeImage& image = TwoCubes()) {
    Problems problems;
    EXPECT_FALSE(RunStage(image, stage, problems));
    return problems.ToString();
  };
  ImageStage stage = ClassStage(1);
  stage.region = VoxelBox{{10, 0, 0}, {5, 8, 8}};
  EXPECT_THAT(refusal(stage), HasSubstr("region: is not inside of the image, which has (14, 8, 8) voxels"));
  stage = ClassStage(1);
  stage.resample = 1e-5;
  EXPECT_THAT(refusal(stage), HasSubstr("resample: makes (1400, 800, 1600) voxels"));
  stage = ClassStage(1);
  stage.filters = {GaussianFilter{1}};
  EXPECT_THAT(refusal(stage), HasSubstr("filters[0].deviation: is more than 20 voxels"));
  stage.filters.clear();
  stage.seeds = {TwoCubes().CentreOf({9, 3, 3}), Vec3(1, 1, 1)};
  EXPECT_THAT(refusal(stage), HasSubstr("seeds[1]: is outside"));
  stage.seeds.pop_back();
  EXPECT_THAT(refusal(stage), HasSubstr("seeds[0]: is in class 2, not in class 1"));
  stage.choice = LabelChoice{{100}};
  stage.cleaning.keep = KeptParts::kSeeds;
  EXPECT_THAT(refusal(stage), HasSubstr("seeds[0]: voxel (9, 3, 3) is not in the body"));
  stage.choice = LabelChoice{{100, 7}};
  EXPECT_THAT(refusal(stage),
              AllOf(HasSubstr("labels[1]: no voxel has the label 7"), HasSubstr("existing labels: 100, 200")));
  stage = ClassStage(1);
  stage.cleaning.opening = 3e-3;
  EXPECT_THAT(refusal(stage), HasSubstr("cleaning.opening: nothing is left"));
  stage = ClassStage(2);
  std::get<Classification>(stage.choice).classes = 5;
  EXPECT_THAT(refusal(stage), HasSubstr("classification.classes: the image has 3 different values"));
  VolumeImage flat = TwoCubes();
  std::fill(flat.values.begin(), flat.values.end(), 3.0F);
  EXPECT_THAT(refusal(ClassStage(1), flat), HasSubstr("1 different values"));
  std::fill(flat.values.begin(), flat.values.end(), 0.0F);
  stage.choice = LabelChoice{};
  EXPECT_THAT(refusal(stage, flat), HasSubstr("all voxels of the mask are 0"));
  stage = ClassStage(1);
  stage.level = 4;
  stage.fraction = 1;
  EXPECT_THAT(refusal(stage), HasSubstr("level: no voxel is left"));
}

}  // namespace
}  // namespace fascicle::testing
