// A scene of the eulerian method through the programs: submit, watch a server that is killed meanwhile, run, export,
// render.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "digest_job.h"

namespace fascicle::testing {
namespace {

using ::testing::HasSubstr;

// A soft cube, given as a surface file, that hangs by its upper side in a plane force field: `frames` frames of 2 ms.
std::string EulerianSceneText(int frames) {
  return R"({"bodies": [{"name": "cube", "unit": "mm", "mesh": {"surface": {"path": "cube.obj"}},
    "material": {"neo_hookean": {"young_modulus": 5000}},
    "regions": [{"name": "top", "box": {"min": [0, 0, 50], "max": [60, 60, 60]}}],
    "constraints": [{"region": "top"}]}],
    "gravity": {"acceleration": [0, 0, -9.81]},
    "squeezes": [{"point": [0.03, 0, 0], "normal": [1, 0, 0], "force_density": 2e4}],
    "duration": )" +
         std::to_string(0.002 * frames) +
         R"(, "output": {"frame_interval": 0.002, "fields": ["volume_ratio", "velocity"]},
    "eulerian": {"cell_size": 0.01, "margin": 0.6}})";
}

constexpr const char* kCube =
    "v 0 0 0\nv 60 0 0\nv 60 60 0\nv 0 60 0\nv 0 0 60\nv 60 0 60\nv 60 60 60\nv 0 60 60\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

class EulerianTest : public ::testing::Test {
 protected:
  EulerianTest() { WriteFile(folder() / "cube.obj", kCube); }
  const TemporaryFolder& folder() const { return job_.folder(); }

  DigestJob job_;
};

TEST_F(EulerianTest, SameDigestsAsRunAlsoWhenKilled) {
  job_.ExpectSameDigestsAsRunAlsoWhenKilled(EulerianSceneText(15), 15);
}

TEST_F(EulerianTest, CanBeCancelled) { job_.ExpectCanBeCancelled(EulerianSceneText(50000)); }

TEST_F(EulerianTest, IsExportedAndDrawn) {
  job_.StartServer();
  const std::string job = job_.Submit(EulerianSceneText(2));
  EXPECT_EQ(job_.Call({"watch", job}).exit_code, 0);
  EXPECT_EQ(job_.Call({"export", job, "--out", folder() / "out"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder() / "out/frames/cube_000002.vtu"));
  EXPECT_THAT(ReadFile(folder() / "out/series.csv"), HasSubstr("cube/reaction/top/z [N]"));
  for (const char* style : {"surface", "wireframe"}) {
    const Finished drawn =
        job_.Call({"render", job, "--out", folder() / "cube.png", "--style", style, "--colour", "volume_ratio"});
    EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  }
  EXPECT_EQ(job_.Call({"plot", job, "--series", "cube/*", "--out", folder() / "plot.png"}).exit_code, 0);
  // A surface has no elements inside.
  for (const std::vector<std::string>& wish : std::vector<std::vector<std::string>>{
           {"--style", "volume"}, {"--fibres"}, {"--style", "slices", "--scan", "x"}}) {
    std::vector<std::string> command = {"render", job, "--out", folder() / "none.png"};
    command.insert(command.end(), wish.begin(), wish.end());
    const Finished refused = job_.Call(command);
    EXPECT_EQ(refused.exit_code, 2) << wish[0];
    EXPECT_THAT(refused.err, HasSubstr("the body `cube` is a surface")) << wish[0];
    EXPECT_FALSE(std::filesystem::exists(folder() / "none.png"));
  }
}

TEST_F(EulerianTest, SettingsCanBeChangedOnTheWay) {
  WriteFile(folder() / "scene.json", EulerianSceneText(2));
  const auto digests = [&](const std::vector<std::string>& more) {
    std::vector<std::string> command = {Program("fascicle"), "run", folder() / "scene.json", "--digests"};
    command.insert(command.end(), more.begin(), more.end());
    const Finished finished = RunProgram(command);
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return FrameLines(finished.out);
  };
  const auto plain = digests({});
  EXPECT_EQ(digests({"--set", "eulerian.volume=preserved"}), plain);
  EXPECT_NE(digests({"--set", "eulerian.volume=none"}), plain);
  const Finished wrong =
      RunProgram({Program("fascicle"), "validate", folder() / "scene.json", "--set", "eulerian.cell_size=0.03"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err + wrong.out, HasSubstr("bodies[0].mesh.surface"));
}

}  // namespace
}  // namespace fascicle::testing
