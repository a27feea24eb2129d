// The scenes of FASCICLE_CASES (stiff, mechanics): the right value of a series, a refusal, or a warning.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/paths.h"
#include "tests/support/scene_loader.h"
#include "tests/support/tet_scenes.h"

namespace fascicle::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class SceneCasesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(CasesFolder() / "stiff")) GTEST_SKIP() << CasesFolder() << " is not there; set FASCICLE_CASES";
  }

  static nlohmann::json ExpectedIn(const std::string& folder) {
    return nlohmann::json::parse(std::ifstream(CasesFolder() / folder / "expected.json"));
  }
  static RunResult Run(const std::string& name) {
    Problems problems;
    const auto scene = ReadScene(CasesFolder() / (name + ".json"), problems);
    if (scene == nullptr) throw std::runtime_error(name + " was refused:\n" + problems.ToString());
    return RunScene(*scene);
  }
  static std::string Refusal(const std::string& name) {
    Problems problems;
    EXPECT_EQ(ReadScene(CasesFolder() / (name + ".json"), problems), nullptr) << name;
    return problems.ToString();
  }
  static std::vector<std::string> ReasonsOf(const RunResult& run) {
    std::vector<std::string> reasons;
    for (const Warning& warning : run.outcome.warnings) reasons.push_back(warning.reason);
    return reasons;
  }
};

// Two bars in a row whose moduli differ by 1e2 to 1e8, and displacements down to 1e-13 m: Newton's method ends at the
// rounding error of the forces, in a few iterations.
TEST_F(SceneCasesTest, StiffBesideSoft) {
  const nlohmann::json expected = ExpectedIn("stiff");
  int rows = 0;
  for (const auto& entry : fs::directory_iterator(CasesFolder() / "stiff")) {
    const std::string name = entry.path().stem();
    if (!name.starts_with("row_") && !name.starts_with("load_")) continue;
    if (expected.at(name).at("want").is_null()) continue;
    const RunResult run = Run("stiff/" + name);
    ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << name << ": " << run.outcome.failure.message;
    const double want = expected[name]["want"], got = run.Last(expected[name]["key"]);
    EXPECT_NEAR(got / want, 1, name.starts_with("row_") ? 1e-4 : 1e-3) << name;
    EXPECT_LE(run.Last("solver/iterations"), 6) << name;
    ++rows;
  }
  EXPECT_GE(rows, 16);
}

// A bone of 17 GPa in tissue of 10 kPa. The value is that with a tolerance of 1e-6, which ends before rounding matters.
TEST_F(SceneCasesTest, BoneInMuscle) {
  const RunResult run = Run("stiff/bone_in_muscle");
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  EXPECT_LE(run.Last("solver/iterations"), 10);
  Problems problems;
  auto loose = std::make_shared<Scene>(*ReadScene(CasesFolder() / "stiff/bone_in_muscle.json", problems));
  loose->tet.newton_tolerance = 1e-6;
  const double want = RunScene(*loose).Last("probe/p/x");
  EXPECT_NEAR(run.Last("probe/p/x"), want, 1e-4 * std::abs(want));
}

TEST_F(SceneCasesTest, MotionsLeftFreeAreRefusedByName) {
  EXPECT_THAT(Refusal("mechanics/held_by_one_point"), HasSubstr("it turns about the point [0, 0, 0] m"));
  EXPECT_THAT(Refusal("mechanics/hinge_line"), HasSubstr("it turns about the line through [0.005, 0, 0] m along x"));
  EXPECT_THAT(Refusal("mechanics/nothing_held_qs"), HasSubstr("no support holds the body along x"));
  EXPECT_THAT(Refusal("mechanics/nothing_held_gravity_qs"), HasSubstr("no support holds the body along x"));
  EXPECT_THAT(Refusal("mechanics/only_z_held"), HasSubstr("no support holds the body along x"));
  EXPECT_THAT(Refusal("mechanics/conflict"), HasSubstr("move differently along x"));
}

// Rotations of any size in any number of frames, Poisson's ratios up to 0.499999, contrasts, small bodies.
TEST_F(SceneCasesTest, Mechanics) {
  const nlohmann::json expected = ExpectedIn("mechanics");
  int rows = 0;
  for (const auto& [name, row] : expected.items()) {
    // Linear elasticity is not made for rotations; see below. One body is refused as too small for a muscle.
    if (row["want"].is_null() || name.ends_with("_linear_elastic") || name == "small_sarcomeres_50um") continue;
    const RunResult run = Run("mechanics/" + name);
    ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << name << ": " << run.outcome.failure.message;
    const double want = row["want"], tolerance = row["tol"];
    EXPECT_NEAR(run.Last(row["key"]), want, std::max(tolerance * std::abs(want), 1e-9)) << name;
    ++rows;
  }
  EXPECT_GE(rows, 25);
}

TEST_F(SceneCasesTest, LinearElasticityIsToldThatItTurns) {
  for (const char* name : {"mechanics/rotate_x_90_linear_elastic", "mechanics/rotate_x_90_voxel_linear_elastic"}) {
    EXPECT_THAT(ReasonsOf(Run(name)), Contains("STRAIN")) << name;
  }
}

// Half of the height in one step ends in another equilibrium than in ten.
TEST_F(SceneCasesTest, ALongStepIsToldToBeOne) {
  EXPECT_THAT(ReasonsOf(Run("mechanics/compress_50")), Contains("LARGE_STEP"));
  EXPECT_THAT(ReasonsOf(Run("mechanics/rotate_x_180_in_1")), IsEmpty());
}

}  // namespace
}  // namespace fascicle::testing
