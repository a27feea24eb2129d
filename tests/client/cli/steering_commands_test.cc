// `fascicle steer`, `replay` and `log`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/eventually.h"
#include "with_server.h"

namespace fascicle::testing {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

// A hanging block of muscle whose lower side is moved.
std::string BlockText(double duration) {
  return R"({"name": "block", "bodies": [{"name": "muscle", "unit": "cm",
    "mesh": {"box": {"size": [2, 2, 4], "divisions": [2, 2, 4]}},
    "material": {"muscle": {"bulk_modulus": 1e5}}, "fibres": {"constant": {"direction": [0, 0, 1]}},
    "regions": [{"name": "low", "plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}},
                {"name": "high", "plane": {"point": [0, 0, 4], "normal": [0, 0, 1]}},
                {"name": "side", "side": {"direction": [1, 0, 0]}}],
    "constraints": [{"region": "low", "motion": {"translation": [{"axis": "x",
                     "curve": {"times": [0, 100], "values": [0.0001, 0.001]}}]}}, {"region": "high"}],
    "loads": [{"region": "side", "traction": {"vector": [10, 0, 0]}}], "damping": {"mass_proportional": 20}}],
    "duration": )" +
         std::to_string(duration) + R"(, "output": {"frame_interval": 0.01}, "tet": {"stepping": "quasi_static"}})";
}

class SteeringCommandsTest : public WithServer<FascicleTest> {
 protected:
  std::string Submit(double duration) { return SubmitText(BlockText(duration)); }
};

std::vector<json> Parse(const std::string& text) {
  std::vector<json> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(json::parse(line));
  return lines;
}

TEST_F(SteeringCommandsTest, AJobIsSteeredReplayedAndLogged) {
  const std::string job = Submit(800);
  const Finished steered = Call({"steer", job, "activation=muscle:0.7", "load=gravity:0.5"});
  EXPECT_EQ(steered.exit_code, 2) << "there is no gravity: " << steered.out << steered.err;
  const Finished first = Call({"steer", job, "activation=muscle:0.2", "load=muscle/side:2", "--json"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(json::parse(first.out)["sequence"], 1);
  EXPECT_EQ(json::parse(first.out)["activations"]["muscle"], 0.2);
  const std::int64_t step = json::parse(first.out)["step"];
  const std::string soon = std::to_string(step + 600);
  EXPECT_THAT(Call({"steer", job, "motion=muscle/low:0.5", "--at-step", soon, "--ramp", "0"}).out,
              HasSubstr("input 2 takes effect with step " + soon));
  EXPECT_EQ(
      Call({"steer", job, "motion=muscle/low:0.5", "--at-step", soon, "--ramp", "0", "--sequence", "2"}).exit_code, 0)
      << "again";
  EXPECT_THAT(Call({"steer", job, "motion=muscle/low:0.6", "--sequence", "2"}).err, HasSubstr("belongs to another"));
  ASSERT_TRUE(Eventually([&] { return Parse(Call({"steer", job, "--list", "--json"}).out)[1]["applied"] == true; }));
  EXPECT_THAT(Call({"steer", job, "--list"}).out,
              AllOf(HasSubstr("input 1 with step " + std::to_string(step)), HasSubstr("activation=muscle:0.2"),
                    HasSubstr("motion=muscle/low:0.5 at once"), HasSubstr("load=muscle/side:VALUE"),
                    Not(HasSubstr("gravity"))));
  EXPECT_EQ(Call({"cancel", job}).exit_code, 0);
  EXPECT_EQ(Call({"log", job, "--follow"}).exit_code, 4) << "it was cancelled";

  const Finished log = Call({"log", job, "--json"});
  int inputs = 0, frames = 0;
  for (const json& line : Parse(log.out)) {
    inputs += line["kind"] == "input";
    frames += line["kind"] == "frame";
  }
  EXPECT_EQ(inputs, 2);
  const json shown = json::parse(Call({"show", job, "--json"}).out);
  EXPECT_EQ(frames, shown["frames"]);
  EXPECT_THAT(Call({"log", job, "--tail", "4"}).out,
              AllOf(HasSubstr("frame "), HasSubstr("1 step, "), HasSubstr("  step ")));
  EXPECT_EQ(Parse(Call({"log", job, "--json", "--tail", "5"}).out).size(), 5u);

  const Finished replay = Call({"replay", job, "--json"});
  EXPECT_EQ(replay.exit_code, 0) << replay.out << replay.err;
  EXPECT_EQ(json::parse(replay.out)["equal"], true);
  EXPECT_EQ(json::parse(replay.out)["frames"], shown["frames"]);
  EXPECT_EQ(Parse(Call({"list", "--json"}).out).size(), 1u) << "the other job is deleted";
}

TEST_F(SteeringCommandsTest, WrongChangesAreToldTogether) {
  const std::string job = Submit(800);
  const Finished wrong = Call({"steer", job, "activation=muscle", "force=x:1", "load=muscle/side:two"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err,
              AllOf(HasSubstr("activation=muscle: must be activation=NAME:NUMBER"),
                    HasSubstr("force=x:1: does not begin with"), HasSubstr("load=muscle/side:two: must be")));
  const Finished unknown =
      Call({"steer", job, "activation=biceps:0.5", "activation=muscle:7", "motion=muscle/high:2", "--at", "900"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err,
              AllOf(HasSubstr("activation=biceps:0.5"), HasSubstr("it has muscle"),
                    HasSubstr("must be in [0, 1], is 7"), HasSubstr("it has muscle/low"), HasSubstr("--at")));
  EXPECT_EQ(Call({"steer", job}).exit_code, 2);
  EXPECT_EQ(Call({"steer", job, "activation=muscle:0.5", "--at", "1", "--at-step", "5"}).exit_code, 2);
  EXPECT_EQ(Call({"cancel", job}).exit_code, 0);
}

}  // namespace
}  // namespace fascicle::testing
