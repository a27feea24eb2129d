// Every stepping, with each element, through a real server: the same digests as `run`, also when the server is killed
// in the middle of the job; and jobs that are cancelled in the middle of a run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <memory>
#include <sstream>
#include <tuple>

#include "child_process.h"

namespace fascicle::testing {
namespace {

// A spindle that contracts and swings, with damping: `frames` frames of 2 ms.
std::string SceneText(const std::string& stepping, const std::string& element, int frames) {
  return R"({"bodies": [{"name": "muscle", "unit": "cm",
    "mesh": {"fusiform": {"length": 6, "belly_radius": 1, "end_radius": 0.6, "divisions_across": 2, "divisions_along": 6}},
    "material": {"muscle": {"bulk_modulus": 1e5}},
    "fibres": {"constant": {"direction": [0, 0, 1]}},
    "regions": [{"name": "origin", "plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}},
                {"name": "insertion", "plane": {"point": [0, 0, 6], "normal": [0, 0, 1]}}],
    "constraints": [{"region": "origin"}, {"region": "insertion", "axes": ["x", "y"]}],
    "activation": {"times": [0, 0.05], "values": [0, 0.3], "interpolation": "smooth"},
    "damping": {"mass_proportional": 20, "viscosity": 1},
    "loads": [{"region": "insertion", "nodal_force": {"total": [0, 0, 1]}}]}],
    "duration": )" +
         std::to_string(0.002 * frames) +
         R"(, "output": {"frame_interval": 0.002, "fields": ["fibre_stretch"]}, "tet": {"stepping": ")" + stepping +
         R"(", "element": ")" + element + R"("}})";
}

std::vector<std::string> FrameLines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("frame ")) lines.push_back(line);
  }
  return lines;
}

class SteppingsTest : public ::testing::TestWithParam<std::tuple<std::string, std::string>> {
 protected:
  void StartServer() {
    server_.reset();
    server_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{FASCICLED_PROGRAM, "--listen", "127.0.0.1:0", "--data", folder_ / "server"});
    const std::string line = server_->ReadLine();
    ASSERT_THAT(line, ::testing::HasSubstr("listening on "));
    address_ = line.substr(line.find("listening on ") + 13);
  }
  Finished Call(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {FASCICLE_PROGRAM, "--server", address_});
    return RunProgram(arguments);
  }
  std::string Submit(int frames) {
    const auto& [stepping, element] = GetParam();
    WriteText(folder_ / "scene.json", SceneText(stepping, element, frames));
    const Finished submitted = Call({"submit", folder_ / "scene.json"});
    EXPECT_EQ(submitted.exit_code, 0) << submitted.err;
    return submitted.out.substr(0, submitted.out.find('\n'));
  }

  ScratchFolder folder_;
  std::unique_ptr<ChildProcess> server_;
  std::string address_;
};

TEST_P(SteppingsTest, SameDigestsAsRunAlsoWhenKilled) {
  constexpr int kFrames = 25;
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

TEST_P(SteppingsTest, CanBeCancelled) {
  StartServer();
  const std::string job = Submit(50000);
  ChildProcess watch({FASCICLE_PROGRAM, "--server", address_, "watch", job, "--digests"});
  for (int i = 0; i < 3; ++i) EXPECT_THAT(watch.ReadLine(), ::testing::StartsWith("frame "));
  EXPECT_EQ(Call({"cancel", job}).exit_code, 0);
  const Finished watched = watch.Wait();
  EXPECT_EQ(watched.exit_code, 4) << watched.err;
  EXPECT_THAT(watched.out, ::testing::HasSubstr("cancelled"));
}

INSTANTIATE_TEST_SUITE_P(Every, SteppingsTest,
                         ::testing::Combine(::testing::Values("explicit", "mixed", "backward_euler", "newmark", "bdf2",
                                                              "quasi_static"),
                                            ::testing::Values("linear", "quadratic")),
                         [](const auto& test) { return std::get<0>(test.param) + "_" + std::get<1>(test.param); });

}  // namespace
}  // namespace fascicle::testing
