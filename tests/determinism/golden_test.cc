// The examples have the digests of golden_digests.txt.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/determinism/golden.h"
#include "tests/support/paths.h"

namespace fascicle::testing {
namespace {

// This file is compiled to two programs.
#ifdef GOLDEN_SLOW
constexpr bool kSlow = true;
#else
constexpr bool kSlow = false;

TEST(GoldenFileTest, HasEachExampleOnce) {
  std::vector<std::string> names;
  for (const GoldenScene& scene : ReadGolden()) names.push_back(scene.name);
  EXPECT_EQ(names, ExampleNames()) << "run deploy/golden";
}
#endif

class GoldenTest : public ::testing::TestWithParam<GoldenScene> {};

TEST_P(GoldenTest, HasItsDigest) {
  if (const std::string why = WhyNotComparable(); !why.empty()) GTEST_SKIP() << why;
  const GoldenRun run = RunGolden(GetParam().name);
  if (!run.missing.empty()) GTEST_SKIP() << run.missing << " is not in " << DataFolder() << "; set FASCICLE_DATA";
  ASSERT_EQ(run.problem, "");
  EXPECT_EQ(run.digest, GetParam().digest)
      << GetParam().name
      << " has other bits than before: where that is meant, run deploy/golden and give the reason in "
      << "the commit message";
}

std::vector<GoldenScene> Scenes() {
  std::vector<GoldenScene> scenes = ReadGolden();
  std::erase_if(scenes, [](const GoldenScene& scene) { return scene.is_slow != kSlow; });
  return scenes;
}

INSTANTIATE_TEST_SUITE_P(Every, GoldenTest, ::testing::ValuesIn(Scenes()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace fascicle::testing
