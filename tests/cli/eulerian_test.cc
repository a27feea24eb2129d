// A scene of the eulerian method through the programs: submit, watch a server that is killed on the way, run, export,
// render.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <memory>
#include <sstream>

#include "child_process.h"

namespace fascicle::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// A soft cube, given as a surface file, that hangs by its upper side and is squeezed: `frames` frames of 2 ms.
std::string SceneText(int frames) {
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

std::vector<std::string> FrameLines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("frame ")) lines.push_back(line);
  }
  return lines;
}

class EulerianTest : public ::testing::Test {
 protected:
  void StartServer() {
    server_.reset();
    server_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{FASCICLED_PROGRAM, "--listen", "127.0.0.1:0", "--data", folder_ / "server"});
    const std::string line = server_->ReadLine();
    ASSERT_THAT(line, HasSubstr("listening on "));
    address_ = line.substr(line.find("listening on ") + 13);
  }
  Finished Call(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {FASCICLE_PROGRAM, "--server", address_});
    return RunProgram(arguments);
  }
  std::string Submit(int frames) {
    WriteText(folder_ / "cube.obj", kCube);
    WriteText(folder_ / "scene.json", SceneText(frames));
    const Finished submitted = Call({"submit", folder_ / "scene.json"});
    EXPECT_EQ(submitted.exit_code, 0) << submitted.err;
    return submitted.out.substr(0, submitted.out.find('\n'));
  }

  ScratchFolder folder_;
  std::unique_ptr<ChildProcess> server_;
  std::string address_;
};

TEST_F(EulerianTest, SameDigestsAsRunAlsoWhenKilled) {
  constexpr int kFrames = 15;
  StartServer();
  const std::string job = Submit(kFrames);
  std::vector<std::string> seen;
  {
    ChildProcess watch({FASCICLE_PROGRAM, "--server", address_, "watch", job, "--digests"});
    for (int i = 0; i < 4; ++i) seen.push_back(watch.ReadLine());
    server_->Signal(SIGKILL);
    server_->Wait();
  }
  StartServer();
  const std::vector<std::string> streamed = FrameLines(Call({"watch", job, "--digests"}).out);
  const Finished run = RunProgram({FASCICLE_PROGRAM, "run", folder_ / "scene.json", "--threads", "2", "--digests"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  ASSERT_EQ(streamed.size(), std::size_t{kFrames + 1});
  EXPECT_EQ(streamed, FrameLines(run.out));
  EXPECT_EQ(seen, std::vector<std::string>(streamed.begin(), streamed.begin() + 4));
}

TEST_F(EulerianTest, CanBeCancelled) {
  StartServer();
  const std::string job = Submit(50000);
  ChildProcess watch({FASCICLE_PROGRAM, "--server", address_, "watch", job, "--digests"});
  for (int i = 0; i < 3; ++i) EXPECT_THAT(watch.ReadLine(), StartsWith("frame "));
  EXPECT_EQ(Call({"cancel", job}).exit_code, 0);
  const Finished watched = watch.Wait();
  EXPECT_EQ(watched.exit_code, 4) << watched.err;
  EXPECT_THAT(watched.out, HasSubstr("cancelled"));
}

TEST_F(EulerianTest, IsExportedAndDrawn) {
  StartServer();
  const std::string job = Submit(2);
  EXPECT_EQ(Call({"watch", job}).exit_code, 0);
  EXPECT_EQ(Call({"export", job, "--out", folder_ / "out"}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/frames/cube_000002.vtu"));
  EXPECT_THAT(ReadText(folder_ / "out/series.csv"), HasSubstr("cube/reaction/top/z [N]"));
  for (const char* style : {"surface", "wireframe"}) {
    const Finished drawn =
        Call({"render", job, "--out", folder_ / "cube.png", "--style", style, "--colour", "volume_ratio"});
    EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  }
  EXPECT_EQ(Call({"plot", job, "--series", "cube/*", "--out", folder_ / "plot.png"}).exit_code, 0);
  // There is nothing inside of a surface.
  for (const std::vector<std::string>& wish : std::vector<std::vector<std::string>>{
           {"--style", "volume"}, {"--fibres"}, {"--style", "slices", "--scan", "x"}}) {
    std::vector<std::string> command = {"render", job, "--out", folder_ / "none.png"};
    command.insert(command.end(), wish.begin(), wish.end());
    const Finished refused = Call(command);
    EXPECT_EQ(refused.exit_code, 2) << wish[0];
    EXPECT_THAT(refused.err, HasSubstr("the body `cube` is a surface")) << wish[0];
    EXPECT_FALSE(std::filesystem::exists(folder_ / "none.png"));
  }
}

TEST_F(EulerianTest, SettingsCanBeChangedOnTheWay) {
  WriteText(folder_ / "cube.obj", kCube);
  WriteText(folder_ / "scene.json", SceneText(2));
  const auto digests = [&](const std::vector<std::string>& more) {
    std::vector<std::string> command = {FASCICLE_PROGRAM, "run", folder_ / "scene.json", "--digests"};
    command.insert(command.end(), more.begin(), more.end());
    const Finished finished = RunProgram(command);
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return FrameLines(finished.out);
  };
  const auto plain = digests({});
  EXPECT_EQ(digests({"--set", "eulerian.volume=preserved"}), plain);
  EXPECT_NE(digests({"--set", "eulerian.volume=none"}), plain);
  const Finished wrong =
      RunProgram({FASCICLE_PROGRAM, "validate", folder_ / "scene.json", "--set", "eulerian.cell_size=0.03"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err + wrong.out, HasSubstr("bodies[0].mesh.surface"));
}

}  // namespace
}  // namespace fascicle::testing
