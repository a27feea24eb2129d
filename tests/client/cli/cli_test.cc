// The command line as users see it: child processes, exit codes, output and files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "fascicle_fixture.h"
#include "with_server.h"

namespace fascicle::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kNobody = "127.0.0.1:1";

// A vibrating block of rubber: `frames` frames of `steps` steps each.
std::string SceneText(int frames, int steps) {
  return R"({"name": "block", "bodies": [{"name": "block", "unit": "cm",
    "mesh": {"box": {"size": [1, 1, 1], "divisions": [3, 3, 3]}},
    "material": {"neo_hookean": {"young_modulus": 1e4}},
    "regions": [{"name": "floor", "plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}}],
    "constraints": [{"region": "floor"}]}],
    "gravity": {"acceleration": [0, 0, -9.81]},
    "duration": )" +
         std::to_string(1e-4 * frames * steps) + R"(, "output": {"frame_interval": )" + std::to_string(1e-4 * steps) +
         R"(, "fields": ["von_mises_stress"]}, "tet": {"time_step": 1e-4}})";
}

std::vector<json> Lines(const std::string& text) {
  std::vector<json> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(json::parse(line));
  return lines;
}

using CliTest = FascicleTest;

TEST_F(CliTest, HelpTellsExitCodesAndExamples) {
  const Finished help = Fascicle({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, AllOf(HasSubstr("Exit codes:"), HasSubstr("3  no server")));
  for (const char* command : {"run",     "submit", "validate", "watch",     "list",   "show",     "cancel",
                              "restart", "verify", "steer",    "replay",    "log",    "delete",   "export",
                              "render",  "plot",   "mesh",     "materials", "schema", "examples", "completion"}) {
    EXPECT_THAT(help.out, HasSubstr(command));
    const Finished own = Fascicle({command, "--help"});
    EXPECT_EQ(own.exit_code, 0) << command;
    EXPECT_THAT(own.out, HasSubstr(std::string("fascicle ") + command)) << command;
  }
}

TEST_F(CliTest, TellsItsVersion) {
  const Finished version = Fascicle({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out, ::testing::MatchesRegex("fascicle [0-9.]+\n"));
}

TEST_F(CliTest, WrongCommandLinesAreInvalidInput) {
  EXPECT_EQ(Fascicle({}).exit_code, 2);
  EXPECT_EQ(Fascicle({"fly"}).exit_code, 2);
  EXPECT_EQ(Fascicle({"run"}).exit_code, 2);
  EXPECT_EQ(Fascicle({"run", "a.json", "--threads", "0"}).exit_code, 2);
  EXPECT_EQ(Fascicle({"render", "x", "--out", "a.png", "--size", "huge"}).exit_code, 2);
  EXPECT_EQ(Fascicle({"list", "--state", "sleeping"}).exit_code, 2);
  EXPECT_EQ(Fascicle({"completion", "tcsh"}).exit_code, 2);
  EXPECT_EQ(Fascicle({"examples", "write", "none"}).exit_code, 2);
  EXPECT_EQ(Fascicle({"schema", "nothing so"}).exit_code, 2);
  EXPECT_EQ(Fascicle({"materials", "none"}).exit_code, 2);
}

TEST_F(CliTest, AWrongCommandGetsTheNearOne) {
  const std::map<std::string, std::string> expected = {
      {"status", "`show` or `list`"}, {"jobs", "`list`"}, {"rendr", "`render`"}, {"kill", "`cancel`"}};
  for (const auto& [wrong, right] : expected) {
    const Finished finished = Fascicle({wrong, "3f2a"});
    EXPECT_EQ(finished.exit_code, 2);
    EXPECT_THAT(finished.err, AllOf(HasSubstr("no command `" + wrong + "`"), HasSubstr("did you mean " + right)));
  }
  const Finished far = Fascicle({"--server", kNobody, "xyzzyplugh", "--json"});
  EXPECT_EQ(far.exit_code, 2);
  EXPECT_THAT(json::parse(far.out)["message"], Not(HasSubstr("did you mean")));
}

TEST_F(CliTest, SchemaSearchesWordsThatAreNoNames) {
  const Finished found = Fascicle({"schema", "strain"});
  EXPECT_EQ(found.exit_code, 0);
  EXPECT_THAT(found.out, AllOf(HasSubstr("\"principal_strains\""), HasSubstr("\"green_lagrange_strain\""),
                               Not(HasSubstr("constraints"))));
  EXPECT_EQ(Fascicle({"schema", "green strain"}).exit_code, 0);
  EXPECT_GE(Lines(Fascicle({"schema", "strain", "--json"}).out).size(), 3u);
}

TEST_F(CliTest, SeveralExamplesAreWrittenAtOnce) {
  const std::string out = folder_ / "scenes";
  EXPECT_EQ(Fascicle({"examples", "write", "bar_twist", "mesh_file.json", "--out", out}).exit_code, 0);
  for (const char* name : {"bar_twist.json", "mesh_file.json", "strip.msh"}) {
    EXPECT_TRUE(fs::exists(fs::path(out) / name)) << name;
  }
  EXPECT_EQ(Fascicle({"examples", "write", "bar_twist", "--all"}).exit_code, 2);
}

// What could not be written is not done, whichever command printed it and in whatever way.
TEST_F(CliTest, OutputThatCannotBeWrittenIsAnError) {
  const std::string scene = File("scene.json", SceneText(2, 5));
  for (const std::string& command : {std::string("schema"), std::string("schema bodies"), std::string("--help"),
                                     std::string("examples"), std::string("materials"), std::string("completion bash"),
                                     "validate " + scene, "--json validate " + scene, "--json run " + scene}) {
    const Finished full = RunProgram({"/bin/sh", "-c", Program("fascicle") + " " + command + " > /dev/full"},
                                     {{"FASCICLE_SERVER", ""}, {"DISPLAY", ""}, {"TMPDIR", Temporary()}});
    EXPECT_EQ(full.exit_code, 1) << command;
    EXPECT_THAT(full.err, HasSubstr("could not be written to stdout")) << command;
  }
  EXPECT_EQ(Fascicle({"schema"}).exit_code, 0);
}

TEST_F(CliTest, WithoutServerEveryCommandSaysSo) {
  const std::string scene = File("scene.json", SceneText(2, 5));
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"submit", scene}, {"list"}, {"show", "x"}}) {
    const Finished finished = Fascicle(command, kNobody);
    EXPECT_EQ(finished.exit_code, 3) << command[0] << finished.err;
    EXPECT_THAT(finished.err, HasSubstr("127.0.0.1:1")) << command[0];
  }
}

TEST_F(CliTest, InvalidScenesListEveryProblem) {
  const std::string scene = File("bad.json", R"({"duraton": 1, "bodies": [{"unit": "inch"}]})");
  for (const char* command : {"run", "validate", "submit"}) {
    const Finished human = Fascicle({command, scene});
    EXPECT_EQ(human.exit_code, 2) << command;
    EXPECT_EQ(human.out, "");
    EXPECT_THAT(human.err,
                AllOf(HasSubstr("duraton: unknown field (did you mean duration?)\n"), HasSubstr("bodies[0].unit: ")));
    const Finished program = Fascicle({command, scene, "--json"});
    EXPECT_EQ(program.exit_code, 2);
    const json object = json::parse(program.out);
    EXPECT_GE(object["problems"].size(), 2u);
  }
  EXPECT_TRUE(fs::is_empty(Temporary())) << "nothing is left behind";
}

TEST_F(CliTest, TheServersProblemsComeTheSameWay) {
  std::string text = SceneText(2, 5);
  text.replace(text.find("1e4"), 3, "-10");
  const std::string scene = File("bad.json", text);
  for (const char* command : {"run", "validate"}) {
    const Finished finished = Fascicle({command, scene});
    EXPECT_EQ(finished.exit_code, 2) << finished.err;
    EXPECT_THAT(finished.err, HasSubstr("bodies[0].material.neo_hookean.young_modulus: "));
  }
}

TEST_F(CliTest, RunLeavesTablesSeriesAndPictures) {
  const std::string scene = File("scene.json", SceneText(4, 20));
  const Finished finished = Fascicle({"run", scene, "--out", folder_ / "out", "--data", folder_ / "data", "--json"});
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const json summary = json::parse(finished.out);
  EXPECT_EQ(summary["state"], "succeeded");
  EXPECT_EQ(summary["frames"], 5);
  const json& kinetic = summary["series"]["energy/kinetic"];
  EXPECT_EQ(kinetic["unit"], "J");
  EXPECT_GE(kinetic["max"], kinetic["final"]);
  EXPECT_GE(kinetic["final"], kinetic["min"]);
  for (const char* file :
       {"series.csv", "series.png", "last.png", "frames.pvd", "frames/block_000004.vtu", "summary.json"}) {
    EXPECT_GT(fs::file_size(folder_.path() / "out" / file), 100u) << file;
  }
  EXPECT_EQ(json::parse(ReadFile(folder_ / "out/summary.json")), summary);
  EXPECT_FALSE(fs::is_empty(folder_.path() / "data"));
}

// A strip of tendon under uniform stretch: each field is the same everywhere.
TEST_F(CliTest, SampleReadsAnExportedFolder) {
  ASSERT_EQ(Fascicle({"examples", "write", "tendon_pull", "--out", folder_.path().string()}).exit_code, 0);
  const std::string out = folder_ / "out";
  const Finished run =
      Fascicle({"run", folder_ / "tendon_pull.json", "--out", out, "--json", "--set", "tet.stepping=quasi_static",
                "--set", R"(output.fields=["volume_ratio", "principal_strains", "reaction_force"])"});
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  // What acts balances the energy.
  const json series = json::parse(run.out)["series"];
  const double elastic = series["energy/elastic"]["final"], work = series["energy/external_work"]["final"];
  EXPECT_GT(elastic, 1e-4);
  EXPECT_NEAR(work, elastic, 1e-6 * elastic);

  const Finished line = Fascicle({"sample", out, "--line", "1,1,1:19,4,4:4", "--unit", "mm", "--json", "--plot",
                                  folder_ / "line.png", "--out", folder_ / "line.csv"});
  ASSERT_EQ(line.exit_code, 0) << line.err;
  const json frame = json::parse(line.out);
  EXPECT_EQ(frame["frame"], 20);
  const json& strain = frame["fields"]["principal_strains/1"]["values"];
  ASSERT_EQ(strain.size(), 4u);
  for (const double value : strain) EXPECT_NEAR(value, std::log(1.02), 1e-6);
  EXPECT_NEAR(frame["fields"]["displacement/x"]["values"][0], 1e-3 * 0.02, 1e-9);
  EXPECT_EQ(frame["fields"]["reaction_force/x"]["unit"], "N");
  EXPECT_GT(fs::file_size(folder_ / "line.png"), 2000u);
  EXPECT_THAT(ReadFile(folder_ / "line.csv"), HasSubstr("frame,time [s],distance [m],x [m],y [m],z [m],"));

  File("points.csv", "x,y,z\n10,2,2\n100,0,0\n");
  const Finished points = Fascicle({"sample", out, "--points", folder_ / "points.csv", "--unit", "mm", "--frames",
                                    "0,20", "--fields", "volume_ratio"});
  ASSERT_EQ(points.exit_code, 0) << points.err;
  EXPECT_EQ(std::count(points.out.begin(), points.out.end(), '\n'), 5);
  EXPECT_THAT(points.out, HasSubstr("\n0,0,1,0.1,0,0,\n")) << "outside: an empty cell";

  const Finished region = Fascicle({"sample", out, "--region", "right", "--json", "--frames", "all"});
  ASSERT_EQ(region.exit_code, 0) << region.err;
  const json last = Lines(region.out).back();
  EXPECT_NEAR(last["area"], 25e-6, 1e-15);
  EXPECT_NEAR(last["fields"]["principal_strains/1"]["mean"], std::log(1.02), 1e-6);

  for (const std::vector<std::string>& wrong : {std::vector<std::string>{"sample", out},
                                                {"sample", out, "--line", "0,0:1,1,1:3"},
                                                {"sample", out, "--region", "x"},
                                                {"sample", out, "--line", "1,0,0:2,0,0:3"},
                                                {"sample", out, "--region", "left", "--fields", "colour"},
                                                {"sample", folder_.path().string(), "--region", "left"}}) {
    const Finished refused = Fascicle(wrong);
    EXPECT_EQ(refused.exit_code, 2) << refused.err;
    EXPECT_NE(refused.err, "");
  }
}

// Everything that takes a job takes the folder of `run --out`, too, and the data folder of a server.
TEST_F(CliTest, AFolderStandsForItsJob) {
  const std::string scene = File("scene.json", SceneText(4, 20)), out = folder_ / "out";
  ASSERT_EQ(Fascicle({"run", scene, "--out", out}).exit_code, 0);
  const Finished again = Fascicle({"run", scene, "--out", out});  // replaces the job of the first run
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("fascicle plot " + out));
  const json job = json::parse(Fascicle({"show", out, "--json"}, kNobody).out);
  EXPECT_EQ(job["frames"], 5);
  const std::string name = job["job"];
  EXPECT_THAT(again.out, HasSubstr(name));
  EXPECT_EQ(Fascicle({"render", out, "--out", File("a.png")}, kNobody).exit_code, 0);
  EXPECT_GT(fs::file_size(File("a.png")), 1000u);
  EXPECT_EQ(Fascicle({"plot", out + "/data", "--out", File("b.png")}, kNobody).exit_code, 0);
  EXPECT_GT(fs::file_size(File("b.png")), 1000u);
  EXPECT_EQ(Fascicle({"export", out + "/" + name, "--out", File("e"), "--format", "csv"}, kNobody).exit_code, 0);
  EXPECT_EQ(ReadFile(folder_ / "e/series.csv"), ReadFile(out + "/series.csv"));
  const std::string last = name.substr(name.size() - 6);
  EXPECT_EQ(json::parse(Fascicle({"show", out + "/jobs/" + last, "--json"}, kNobody).out)["job"], name);
  const Finished none = Fascicle({"plot", folder_ / "tmp"}, kNobody);
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("keeps no job"));
  const Finished unknown = Fascicle({"show", out + "/jobs/zzz"}, kNobody);
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("no job's name begins or ends with zzz"));
}

// A dynamic run starts where a static one ended, and another one where that was, from folders.
TEST_F(CliTest, ARunStartsWhereAnotherEnded) {
  const Finished example = Fascicle({"examples", "show", "released_bar"});
  json scene = json::parse(example.out, nullptr, true, true);
  scene.erase("start");
  scene["bodies"][0]["loads"][0].erase("scale");
  scene["duration"] = 0.05;
  const std::string dynamic = File("dynamic.json", scene.dump());
  scene["tet"] = {{"stepping", "quasi_static"}};
  const std::string quasi_static = File("static.json", scene.dump());
  const std::string out = folder_ / "out", after = folder_ / "after";
  const auto run = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"run", "--json"});
    const Finished finished = Fascicle(arguments);
    EXPECT_EQ(finished.exit_code, 0) << finished.err << finished.out;
    return json::parse(finished.out);
  };
  const double end = run({quasi_static, "--out", out})["series"]["probe/end/z"]["final"];
  EXPECT_LT(end, -0.005);
  const json second = run({dynamic, "--out", after, "--start", out});
  EXPECT_NEAR(second["series"]["probe/end/z"]["min"], end, 1e-9);
  EXPECT_NEAR(second["series"]["probe/end/z"]["max"], end, 1e-9);
  EXPECT_THAT(second["notes"].dump(), HasSubstr("start.frame: begins as frame 5 (0.05 s) of jobs/"));
  // In place: the folder's own job is read before it is replaced. A scene may name the job, too.
  EXPECT_EQ(run({dynamic, "--out", after, "--start", after + ":2"})["state"], "succeeded");
  EXPECT_EQ(run({dynamic, "--set", R"(start={"frame": {"job": ")" + after + R"("}})"})["state"], "succeeded");

  const auto refused = [&](const std::string& start, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"run", dynamic, "--start", start};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished finished = Fascicle(arguments, kNobody);
    EXPECT_EQ(finished.exit_code, 2) << finished.err;
    return finished.err;
  };
  EXPECT_THAT(refused(out + ":99"), HasSubstr("has 6 frames, from 0 on"));
  EXPECT_THAT(refused(out + ":last"), HasSubstr("--start: expects JOB or JOB:FRAME"));
  EXPECT_THAT(refused(out, {"--set", "bodies[0].mesh.box.divisions=[6, 1, 1]"}),
              HasSubstr("start.frame: has another mesh"));
  EXPECT_THAT(refused(out, {"--set", "tet.element=linear"}), HasSubstr("start.frame: has other mid-edge nodes"));
}

// A data folder that a server wrote before frames had mid-edge nodes, of a scene with quadratic elements.
TEST_F(CliTest, JobsOfOlderServersStayReadable) {
  const fs::path old = ProjectRoot() / "tests/client/cli/old_jobs";
  const Finished unpacked =
      RunProgram({"/bin/tar", "xzf", (old / "corner_nodes.tar.gz").string(), "-C", folder_.path().string()});
  ASSERT_EQ(unpacked.exit_code, 0) << unpacked.err;
  const std::string data = folder_ / "data";
  EXPECT_EQ(json::parse(Fascicle({"show", data, "--json"}, kNobody).out)["frames"], 3);
  const Finished region = Fascicle({"sample", data, "--region", "right", "--json"}, kNobody);
  ASSERT_EQ(region.exit_code, 0) << region.err;
  EXPECT_NEAR(json::parse(region.out)["fields"]["displacement/z"]["mean"], -0.01277342902, 1e-9);
  const Finished fibres = Fascicle({"sample", data, "--fibres", "--deformed", "--json"}, kNobody);
  ASSERT_EQ(fibres.exit_code, 0) << fibres.err;
  EXPECT_EQ(Fascicle({"export", data, "--out", File("e")}, kNobody).exit_code, 0);
  EXPECT_GT(fs::file_size(folder_.path() / "e/frames/box_000002.vtu"), 500u);
  EXPECT_EQ(Fascicle({"render", data, "--out", File("a.png"), "--wireframe", "--fibres"}, kNobody).exit_code, 0);
  const std::string scene = File("again.json", ReadFile(old / "corner_nodes.json"));
  const Finished again = Fascicle({"validate", scene, "--start", data});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("start.frame: has corner nodes of `box` only"));
  EXPECT_THAT(again.err, HasSubstr("run jobs of older versions again"));
}

TEST_F(CliTest, PicturesOfOtherFormatsAreRefused) {
  const std::string scene = File("scene.json", SceneText(2, 5)), out = folder_ / "out";
  ASSERT_EQ(Fascicle({"run", scene, "--out", out}).exit_code, 0);
  for (const char* command : {"render", "plot"}) {
    const Finished finished = Fascicle({command, out, "--out", File("a.mp4")});
    EXPECT_EQ(finished.exit_code, 2) << command;
    EXPECT_THAT(finished.err, HasSubstr("must end in .png")) << command;
    EXPECT_FALSE(HasFile("a.mp4")) << command;
  }
}

// A bar of rubber that one step compresses to half its height.
TEST_F(CliTest, WarningsEndTheSummary) {
  const std::string scene = File("compressed.json", R"({"name": "compressed", "bodies": [{"name": "bar", "unit": "mm",
    "mesh": {"box": {"size": [10, 10, 10], "divisions": [2, 2, 2]}},
    "material": {"mooney_rivlin": {"c1": 2e3, "c2": 1e3, "bulk_modulus": 1e6}},
    "regions": [{"name": "low", "plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}},
                {"name": "high", "plane": {"point": [0, 0, 10], "normal": [0, 0, 1]}}],
    "constraints": [{"region": "low"}, {"region": "high",
      "motion": {"translation": [{"axis": "z", "curve": {"times": [0, 1], "values": [0, -0.005]}}]}}]}],
    "duration": 1, "output": {"frame_interval": 1}, "tet": {"stepping": "quasi_static"}})");
  const Finished run = Fascicle({"run", scene, "--out", folder_ / "out"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("warning  LARGE_STEP, bar, t = 1 s: a single step"), HasSubstr("  try: ")));
  const json job = json::parse(Fascicle({"show", folder_ / "out", "--json"}).out);
  ASSERT_GE(job["warnings"].size(), 1u);
  EXPECT_EQ(job["warnings"].back()["reason"], "LARGE_STEP");
  EXPECT_EQ(job["warnings"].back()["body"], "bar");
}

TEST_F(CliTest, RunWithoutDataLeavesNothing) {
  const Finished finished = Fascicle({"run", File("scene.json", SceneText(2, 5))});
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_THAT(finished.out, AllOf(HasSubstr("succeeded"), HasSubstr("energy/elastic")));
  EXPECT_THAT(finished.err, Not(HasSubstr("\x1b"))) << "no bar without a terminal";
  EXPECT_TRUE(fs::is_empty(Temporary()));
}

TEST_F(CliTest, RunTellsWhereTheTimeWent) {
  const std::string scene = File("scene.json", SceneText(20, 50));
  const Finished text = Fascicle({"run", scene, "--profile"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("\nstage "), HasSubstr("\nset-up "), HasSubstr("\n  elastic force "),
                              HasSubstr("\nwhole "), HasSubstr("meanwhile"), HasSubstr("\nencode ")));
  EXPECT_THAT(Fascicle({"run", scene}).out, Not(HasSubstr("elastic force")));
  const json summary = json::parse(Fascicle({"run", scene, "--profile", "--json"}).out);
  const json& profile = summary["profile"];
  double top = profile["rest_seconds"];
  int steps = 0;
  for (const json& stage : profile["stages"]) {
    EXPECT_GE(stage["seconds"], 0);
    if (stage["name"] == "step") steps += stage["calls"].get<int>();
    if (!stage.contains("concurrent") && stage["name"].get<std::string>().find('/') == std::string::npos) {
      top += stage["seconds"].get<double>();
    }
  }
  EXPECT_EQ(steps, 1000);
  EXPECT_NEAR(top, profile["wall_seconds"], 1e-9);
  EXPECT_GT(profile["wall_seconds"], 0);
}

// A bar of 40 x 10 x 10 mm in equilibrium; `end` is what happens at its free end.
std::string BarText(const std::string& start, const std::string& end) {
  return R"({"bodies": [{"name": "bar", "unit": "mm",
    "mesh": {"box": {"size": [40, 10, 10], "divisions": [4, 1, 1]}}, "material": {"neo_hookean": {"young_modulus": 1e5}},
    "regions": [{"name": "x0", "plane": {"point": [0, 0, 0], "normal": [-1, 0, 0]}},
                {"name": "y0", "plane": {"point": [0, 0, 0], "normal": [0, -1, 0]}},
                {"name": "z0", "plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}},
                {"name": "x1", "plane": {"point": [40, 0, 0], "normal": [1, 0, 0]}}],
    "constraints": [)" +
         start + R"(], "loads": [{"region": "x1", "traction": {"vector": )" + end + R"(}}]}],
    "duration": 1, "output": {"frame_interval": 0.5}, "tet": {"stepping": "quasi_static", "element": "linear"}})";
}

// Linear elements stretch exactly and bend too stiffly.
TEST_F(CliTest, CheckTellsWhetherTheAnswerHasConverged) {
  const std::string stretched = File(
      "stretched.json",
      BarText(R"({"region": "x0", "axes": ["x"]}, {"region": "y0", "axes": ["y"]}, {"region": "z0", "axes": ["z"]})",
              "[1e4, 0, 0]"));
  const Finished exact = Fascicle({"run", stretched, "--check", "--out", folder_ / "out", "--json"});
  ASSERT_EQ(exact.exit_code, 0) << exact.err;
  const json check = json::parse(exact.out)["check"];
  ASSERT_EQ(check.size(), 2u);
  EXPECT_EQ(check[0]["with"], "half the time step");
  EXPECT_EQ(check[1]["with"], "half the mesh size");
  for (const json& run : check) {
    EXPECT_EQ(run["state"], "succeeded");
    EXPECT_LT(run["largest_change"]["relative_change"], 1e-6) << run;
  }
  // The folder keeps the job of the scene itself.
  EXPECT_EQ(json::parse(Fascicle({"show", folder_ / "out", "--json"}).out)["state"], "succeeded");

  const std::string bent = File("bent.json", BarText(R"({"region": "x0"})", "[0, 0, 100]"));
  const Finished coarse = Fascicle({"run", bent, "--check"});
  ASSERT_EQ(coarse.exit_code, 0) << coarse.err;
  EXPECT_THAT(coarse.out, AllOf(HasSubstr("half the time step: changes at most"),
                                HasSubstr("the answer is not converged: run with half the mesh size")));
  const json finer = json::parse(Fascicle({"run", bent, "--check", "--json"}).out)["check"][1];
  EXPECT_GT(finer["largest_change"]["relative_change"], 0.1);
}

TEST_F(CliTest, SettingsChangeTheScene) {
  const std::string scene = File("scene.json", SceneText(2, 5));
  const auto set = [&](const std::string& setting) { return Fascicle({"validate", scene, "--set", setting}); };
  const Finished shorter =
      Fascicle({"run", scene, "--json", "--set", "duration=0.0005", "--set",
                "bodies[0].material={\"linear_elastic\": {\"young_modulus\": 1e4}}", "--set", "name=half as long"});
  EXPECT_EQ(shorter.exit_code, 0) << shorter.err;
  EXPECT_EQ(json::parse(shorter.out)["frames"], 2);
  EXPECT_EQ(set("bodies[0].density=900").exit_code, 0) << "adds what is not there";
  // Problems are reported with the path that was set.
  const Finished negative = set("bodies[0].density=-1");
  EXPECT_EQ(negative.exit_code, 2);
  EXPECT_THAT(negative.err, HasSubstr("bodies[0].density: "));
  for (const std::string setting :
       {"bodies[7].density=1", "bodies.density=1", "bodies[0].[1]=2", "duration", "=1", "bodies[x]=1", "..=1"}) {
    const Finished finished = set(setting);
    EXPECT_EQ(finished.exit_code, 2) << setting;
    EXPECT_THAT(finished.err, HasSubstr("--set")) << setting;
  }
}

TEST_F(CliTest, AFailedJobSaysWhy) {
  std::string text = SceneText(10, 100);
  const std::string floor = R"({"region": "floor"}])";  // and a lid that is pushed through it
  text.replace(text.find(floor), floor.size(), R"({"region": "floor"}, {"region": "lid", "motion": {"translation":
    [{"axis": "z", "curve": {"times": [0, 0.05], "values": [0, -0.02]}}]}}])");
  const std::string regions = R"("regions": [)";
  text.replace(text.find(regions), regions.size(),
               regions + R"({"name": "lid", "plane": {"point": [0, 0, 1], "normal": [0, 0, 1]}}, )");
  const Finished finished = Fascicle({"run", File("scene.json", text), "--json"});
  EXPECT_EQ(finished.exit_code, 1) << finished.out << finished.err;
  const json summary = json::parse(finished.out);
  EXPECT_EQ(summary["state"], "failed");
  EXPECT_FALSE(summary["failure"]["reason"].get<std::string>().empty());
}

TEST_F(CliTest, CtrlCCancelsARun) {
  ChildProcess run({Program("fascicle"), "run", File("scene.json", SceneText(1000, 1000)), "--json"},
                   {{"TMPDIR", Temporary()}});
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  run.Signal(SIGINT);
  const Finished finished = run.Wait();
  EXPECT_EQ(finished.exit_code, 4) << finished.err;
  EXPECT_EQ(json::parse(finished.out)["state"], "cancelled");
  EXPECT_TRUE(fs::is_empty(Temporary()));
}

// Line muscles are computed alone, whatever else the scene has.
TEST_F(CliTest, ActivationsAndMomentArmsOfASceneWithObstacles) {
  ASSERT_EQ(Fascicle({"examples", "write", "upper_arm", "--out", folder_ / "arm"}).exit_code, 0);
  const std::string scene = folder_ / "arm/upper_arm.json", table = folder_ / "table.csv";
  const std::string ball =
      R"(rigid_bodies=[{"name": "ball", "unit": "mm", "sphere": {"radius": 5}, "position": [500, 0, 0], "bodies": ["biceps"]}])";
  for (const char* command : {"activations", "moment-arms"}) {
    const Finished done = Fascicle({command, scene, "--set", ball, "--csv", table});
    EXPECT_EQ(done.exit_code, 0) << done.err;
    EXPECT_THAT(ReadFile(table), HasSubstr("biceps_line"));
  }
}

TEST_F(CliTest, EveryExampleCanBeWrittenAndIsValid) {
  const Finished written = Fascicle({"examples", "write", "--all", "--out", folder_ / "examples"});
  EXPECT_EQ(written.exit_code, 0) << written.err;
  int valid = 0;
  for (const json& example : Lines(Fascicle({"examples", "--json"}).out)) {
    if (!example["needs"].empty()) continue;  // a mesh of another user
    const Finished checked =
        Fascicle({"validate", folder_ / ("examples/" + example["example"].get<std::string>() + ".json")});
    EXPECT_EQ(checked.exit_code, 0) << example["example"] << checked.err;
    ++valid;
  }
  EXPECT_GE(valid, 9);
  EXPECT_EQ(Fascicle({"examples", "write", "bar_tension", "--out", folder_ / "examples"}).exit_code, 2)
      << "not overwritten";
}

TEST_F(CliTest, SchemaTellsUnitsRangesAndDefaults) {
  const Finished all = Fascicle({"schema"});
  EXPECT_EQ(all.exit_code, 0);
  EXPECT_THAT(all.out, AllOf(HasSubstr("density: number [kg/m^3], (0, 30000], default 1060"), HasSubstr("\"mm\"")));
  EXPECT_THAT(Fascicle({"schema", "fusiform"}).out, AllOf(HasSubstr("FusiformShape"), Not(HasSubstr("BoxShape"))));
  for (const json& type : Lines(Fascicle({"schema", "--json"}).out)) {
    for (const json& field : type.value("fields", json::array())) {
      EXPECT_FALSE(field["comment"].get<std::string>().empty()) << field;
      const bool number = field["type"] == "number" || field["type"] == "whole number";
      const bool ruled = field.contains("range") || field["name"] == "physical_tag" || type["message"] == "Curve";
      EXPECT_TRUE(!number || ruled) << type["message"] << field;
    }
  }
}

TEST_F(CliTest, MaterialCurvesAsTableAndPlot) {
  const Finished list = Fascicle({"materials", "--json"});
  EXPECT_EQ(Lines(list.out).size(), 15u);
  const Finished curve = Fascicle({"materials", "curve", "muscle", "--activation", "0", "1", "--stretch", "1", "1.4",
                                   "--points", "5", "--csv", folder_ / "curve.csv", "--out", folder_ / "curve.png"});
  EXPECT_EQ(curve.exit_code, 0) << curve.err;
  EXPECT_THAT(curve.out, HasSubstr("activation 1"));
  EXPECT_GT(fs::file_size(folder_ / "curve.png"), 1000u);
  const std::string csv = ReadFile(folder_ / "curve.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 6);
  const std::vector<json> curves = Lines(Fascicle({"materials", "curve", "muscle", "--activation", "0", "1",
                                                   "--stretch", "1", "1.4", "--points", "5", "--json"})
                                             .out);
  ASSERT_EQ(curves.size(), 2u);
  EXPECT_NEAR(curves[0]["nominal_stress"][0].get<double>(), 0, 1e-6) << "no stress at rest";
  EXPECT_GT(curves[1]["nominal_stress"][4], curves[0]["nominal_stress"][4]) << "activation pulls";
  const std::vector<json> slow =
      Lines(Fascicle({"materials", "curve", "muscle", "--activation", "1", "--set", "max_velocity=10", "--velocity",
                      "-7", "--stretch", "1", "1.4", "--points", "5", "--json"})
                .out);
  ASSERT_EQ(slow.size(), 1u);
  // -7/s at an optimal stretch of 1.4 is half of the largest speed: Hill's (1 - 0.5)/(1 + 0.5/0.25) of the active
  // stress.
  const double held = curves[1]["cauchy_stress"][4].get<double>() - curves[0]["cauchy_stress"][4].get<double>();
  EXPECT_NEAR(slow[0]["cauchy_stress"][4].get<double>() - curves[0]["cauchy_stress"][4].get<double>(), held / 6,
              0.01 * held);
  const Finished bad = Fascicle({"materials", "curve", "neo_hookean", "--set", "poisson_ratio=0.7", "--set", "x=1"});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.err,
              AllOf(HasSubstr("young_modulus: is required"), HasSubstr("0.7 is out of range"), HasSubstr("--set x")));
}

// A table of a law's own curve: compared, and fitted from other values.
TEST_F(CliTest, MaterialCurvesBesideMeasuredOnes) {
  const std::string table = folder_ / "test.csv";
  std::string text = "stretch, nominal stress [Pa]\n";
  // Incompressible neo-Hookean rubber of shear modulus 60 kPa: P = 6e4 (s - 1/s^2).
  for (const double s : {0.8, 1.1, 1.3, 1.6, 2.0}) {
    text += std::to_string(s) + ", " + std::to_string(6e4 * (s - 1 / (s * s))) + "\n";
  }
  std::ofstream(table) << text;
  const std::vector<std::string> law = {
      "materials", "curve", "mooney_rivlin", "--set", "c1=1e4", "--set", "bulk_modulus=1e11", "--data", table};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), law.begin(), law.end());
    return Fascicle(more);
  };
  const Finished overlay = with({"--out", folder_ / "overlay.png"});
  EXPECT_EQ(overlay.exit_code, 0) << overlay.err;
  EXPECT_THAT(overlay.out, AllOf(HasSubstr("measured"), HasSubstr("root mean square")));
  EXPECT_GT(fs::file_size(folder_ / "overlay.png"), 1000u);
  const std::vector<json> lines = Lines(with({"--fit", "c1", "c2", "--json"}).out);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_TRUE(lines[0]["converged"].get<bool>());
  EXPECT_NEAR(lines[0]["parameters"]["c1"].get<double>(), 3e4, 1);
  EXPECT_NEAR(lines[0]["parameters"]["c2"].get<double>(), 0, 1);
  EXPECT_LT(lines[0]["residual"].get<double>(), 1);
  EXPECT_EQ(lines[1]["stretch"][0], 0.8) << "the curve covers the data";
  EXPECT_THAT(with({"--fit", "c7"}).err, AllOf(HasSubstr("--fit c7"), HasSubstr("unknown parameter")));
  std::ofstream(table) << "1.1 200\n1.2\n-1 5\n";
  const Finished bad = with({});
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.err, AllOf(HasSubstr("line 2"), HasSubstr("line 3")));
  EXPECT_THAT(Fascicle({"materials", "curve", "tendon", "--fit", "c1"}).err, HasSubstr("--data FILE"));
}

TEST_F(CliTest, CompletionKnowsCommandsAndOptions) {
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const Finished script = Fascicle({"completion", shell});
    EXPECT_EQ(script.exit_code, 0);
    EXPECT_THAT(script.out, AllOf(HasSubstr("materials"), HasSubstr("digests"))) << shell;
  }
  WriteFile(folder_ / "completion.bash", Fascicle({"completion", "bash"}).out);
  const auto complete = [&](const std::string& words, int index) {
    return RunProgram({"/bin/bash", "-c",
                       "source " + (folder_ / "completion.bash") + "; COMP_WORDS=(" + words +
                           "); COMP_CWORD=" + std::to_string(index) + "; _fascicle; echo \"${COMPREPLY[@]}\""})
        .out;
  };
  EXPECT_EQ(complete("fascicle va", 1), "validate\n");
  EXPECT_EQ(complete("fascicle watch 3f --di", 3), "--digests\n");
  EXPECT_EQ(complete("fascicle --json materials cu", 3), "curve\n");
  EXPECT_EQ(complete("fascicle materials curve muscle --act", 4), "--activation\n");
  // Values: of options, of examples and laws.
  EXPECT_EQ(complete("fascicle render 3f --style wi", 4), "wireframe\n");
  EXPECT_EQ(complete("fascicle list --state succ", 3), "succeeded\n");
  EXPECT_EQ(complete("fascicle examples write bar_tw", 3), "bar_twist\n");
  EXPECT_EQ(complete("fascicle materials curve neo", 3), "neo_hookean\n");
}

// The same through an external server.
class ServerTest : public WithServer<CliTest> {
 protected:
  std::string Submit(int frames, int steps) { return SubmitText(SceneText(frames, steps)); }
};

TEST_F(ServerTest, AJobsWholeLife) {
  const std::string job = Submit(5, 20);
  const Finished watched = Call({"watch", job, "--json"});
  EXPECT_EQ(watched.exit_code, 0) << watched.err;
  EXPECT_EQ(json::parse(watched.out)["frames"], 6);
  EXPECT_EQ(json::parse(Call({"show", job, "--json"}).out)["state"], "succeeded");
  EXPECT_THAT(Call({"show", job.substr(5)}).out, HasSubstr("succeeded"));
  EXPECT_EQ(Lines(Call({"list", "--json", "--state", "succeeded"}).out).size(), 1u);
  EXPECT_THAT(Call({"list"}).out,
              AllOf(HasSubstr(job), HasSubstr(" kB  20"), ::testing::ContainsRegex(" 0:0[0-9]  block")));
  EXPECT_THAT(Call({"watch", job}).err, HasSubstr("frames 6"));
  // Names of jobs are completed from the server.
  const std::string script = File("completion.bash", Call({"completion", "bash"}).out);
  const std::string bin = fs::path(Program("fascicle")).parent_path().string();
  EXPECT_EQ(RunProgram({"/bin/bash", "-c",
                        "PATH=" + bin + ":$PATH; source " + script +
                            "; COMP_WORDS=(fascicle show jobs/); COMP_CWORD=2; "
                            "_fascicle; echo \"${COMPREPLY[@]}\""},
                       {{"FASCICLE_SERVER", address_}})
                .out,
            job + "\n");
  EXPECT_THAT(Call({"show", job, "--profile"}).out, AllOf(HasSubstr("\n  elastic force"), Not(HasSubstr("succeeded"))));
  const json profile = json::parse(Call({"show", job, "--profile", "--json"}).out);
  EXPECT_EQ(profile["runs"], 1);
  EXPECT_EQ(json::parse(Call({"watch", job, "--profile", "--json"}).out)["profile"], profile);
  // The scene comes back as a scene file.
  EXPECT_EQ(Call({"validate", File("again.json", Call({"show", job, "--scene"}).out)}).exit_code, 0);

  EXPECT_EQ(Call({"export", job, "--out", folder_ / "out", "--from", "1", "--to", "4", "--every", "3"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "out/frames/block_000004.vtu"));
  EXPECT_FALSE(fs::exists(folder_ / "out/frames/block_000002.vtu"));
  const std::string csv = ReadFile(folder_ / "out/series.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
  EXPECT_EQ(Call({"export", job, "--out", folder_ / "out", "--from", "99"}).exit_code, 2);

  const Finished sampled = Call({"sample", job, "--region", "floor", "--frames", "1,3", "--json"});
  EXPECT_EQ(sampled.exit_code, 0) << sampled.err;
  EXPECT_EQ(Lines(sampled.out).size(), 2u);
  EXPECT_EQ(Call({"sample", job, "--region", "floor", "--frames", "99"}).exit_code, 2);

  const Finished rendered = Call({"render", job, "--out", folder_ / "a.png", "--frame", "2", "--size", "200x150",
                                  "--wireframe", "--colour", "von_mises_stress", "--view", "front"});
  EXPECT_EQ(rendered.exit_code, 0) << rendered.err;
  EXPECT_GT(fs::file_size(folder_ / "a.png"), 2000u);
  EXPECT_EQ(Call({"render", job, "--out", folder_ / "b.png", "--frame", "77"}).exit_code, 2);

  const std::vector<json> series = Lines(Call({"plot", job, "--series", "energy/*", "--json"}).out);
  ASSERT_GE(series.size(), 2u);
  EXPECT_EQ(series[0]["values"].size(), 6u);
  EXPECT_THAT(Call({"plot", job, "--series", "energy/kinetic"}).out, HasSubstr("energy/kinetic"));
  EXPECT_EQ(Call({"plot", job, "--series", "none*"}).exit_code, 2);
  // Series plotted against each other, of two jobs in one picture, from a given time on.
  const std::string other = Submit(5, 20);
  EXPECT_EQ(Call({"watch", other, "--json"}).exit_code, 0);
  const std::vector<json> lines = Lines(Call({"plot", job, other, "--series", "energy/kinetic", "--x", "energy/elastic",
                                              "--from", "0.003", "--out", folder_ / "xy.png", "--json"})
                                            .out);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0]["values"].size(), 4u);
  EXPECT_EQ(lines[0]["x"], lines[1]["x"]);
  EXPECT_GT(fs::file_size(folder_ / "xy.png"), 2000u);
  EXPECT_EQ(Call({"plot", job, "--x", "none"}).exit_code, 2);

  EXPECT_THAT(Call({"verify", job}).out, HasSubstr("intact"));
  EXPECT_EQ(Call({"verify", "--all"}).exit_code, 0);
  EXPECT_EQ(Call({"verify"}).exit_code, 2);
  EXPECT_EQ(Call({"restart", job, "--from-start"}).exit_code, 0);
  EXPECT_EQ(Call({"watch", job, "--json"}).exit_code, 0);
  EXPECT_EQ(json::parse(Call({"show", job, "--json"}).out)["attempt"], 2);
  EXPECT_EQ(Call({"delete", job}).exit_code, 0);
  EXPECT_EQ(Call({"show", job}).exit_code, 2) << "it is gone";
}

TEST_F(ServerTest, RunningJobsCanBeCancelledButNotDeleted) {
  const std::string job = Submit(1000, 1000);
  EXPECT_EQ(Call({"delete", job}).exit_code, 2);
  EXPECT_EQ(Call({"cancel", job}).exit_code, 0);
  const Finished watched = Call({"watch", job, "--json"});
  EXPECT_EQ(watched.exit_code, 4) << watched.err;
  EXPECT_EQ(json::parse(watched.out)["state"], "cancelled");
  for (const char* command : {"show", "cancel", "restart", "verify", "steer", "replay", "log", "delete", "watch"}) {
    EXPECT_EQ(Call({command, "jobs/none"}).exit_code, 2) << command;
  }
}

TEST_F(ServerTest, ManyScenesAreSubmittedTogether) {
  const std::string a = File("a.json", SceneText(2, 20)), b = File("b.json", SceneText(3, 20));
  const Finished two = Call({"submit", a, b, "--label", "study=many"});
  EXPECT_EQ(two.exit_code, 0) << two.err;
  EXPECT_EQ(std::count(two.out.begin(), two.out.end(), '\n'), 2);
  const Finished sweep = Call({"submit", a, "--sweep", "bodies[0].density=[1000, 1060]", "--sweep",
                               "duration=[0.01, 0.02, 0.03]", "--label", "study=many", "--json"});
  EXPECT_EQ(sweep.exit_code, 0) << sweep.err;
  std::vector<std::string> names;
  for (const json& job : Lines(sweep.out)) names.push_back(job["scene"]);
  ASSERT_EQ(names.size(), 6U);
  EXPECT_TRUE(names[1].ends_with(", bodies[0].density=1000, duration=0.02")) << names[1];
  const Finished last = Call({"show", Lines(sweep.out)[5]["job"], "--scene"});
  EXPECT_EQ(json::parse(last.out)["duration"], 0.03) << last.out << last.err;
  const Finished listed = Call({"list", "--filter", "labels.study=many", "--json"});
  EXPECT_EQ(Lines(listed.out).size(), 8U) << listed.err;
}

TEST_F(ServerTest, JobsThatAreDearToCheckAreSubmittedInSmallerBatches) {
  json scene = json::parse(SceneText(2, 20));
  scene["bodies"][0]["mesh"]["box"]["divisions"] = {40, 40, 40};
  std::string values = "1000";
  for (int i = 1; i < 40; ++i) values += ", " + std::to_string(1000 + i);
  const Finished submitted = Call({"submit", File("dear.json", scene.dump()), "--sweep",
                                   "bodies[0].density=[" + values + "]", "--label", "study=dear", "--json"});
  EXPECT_EQ(submitted.exit_code, 0) << submitted.err;
  const std::vector<json> jobs = Lines(submitted.out);
  ASSERT_EQ(jobs.size(), 40U);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    EXPECT_TRUE(std::string(jobs[i]["scene"]).ends_with("density=" + std::to_string(1000 + i)));
  }
  const Finished listed = Call({"list", "--filter", "labels.study=dear", "--limit", "100", "--json"});
  EXPECT_EQ(Lines(listed.out).size(), 40U) << "each was created once";
}

TEST_F(ServerTest, NothingIsSubmittedOfScenesOfWhichOneIsInvalid) {
  const std::string good = File("good.json", SceneText(2, 20));
  const std::string unknown = File("unknown.json", R"({"name": "x", "methd": {}})");
  const Finished read = Call({"submit", good, unknown, "--label", "study=none"});
  EXPECT_EQ(read.exit_code, 2);
  EXPECT_NE(read.err.find("unknown.json: methd"), std::string::npos) << read.err;
  const Finished checked = Call({"submit", good, "--sweep", "duration=[1, -1]", "--label", "study=none"});
  EXPECT_EQ(checked.exit_code, 2);
  EXPECT_NE(checked.err.find("good.json, duration=-1: duration"), std::string::npos) << checked.err;
  const Finished started = Call({"submit", good, good, "--start", "nowhere", "--label", "study=none"});
  EXPECT_EQ(started.exit_code, 2) << started.err;
  const Finished meshes = Call({"submit", good, "--sweep", R"(duration=["a", "b", 1])", "--label", "study=none"});
  EXPECT_NE(meshes.err.find("duration=\"a\""), std::string::npos) << meshes.err;
  EXPECT_EQ(Lines(Call({"list", "--filter", "labels.study=none", "--json"}).out).size(), 0U);
  for (const char* sweep : {"duration", "duration=1", "duration=[]", "=[1]"}) {
    EXPECT_EQ(Call({"submit", good, "--sweep", sweep}).exit_code, 2) << sweep;
  }
}

TEST_F(ServerTest, JobsHaveOwnersLabelsAndPriorities) {
  const std::string scene = File("scene.json", SceneText(5, 20));
  const auto submit = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"submit", scene});
    const Finished finished = Call(options);
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return finished.out.substr(0, finished.out.find('\n'));
  };
  const std::string mine = submit({"--label", "study=left knee", "--label", "run=2", "--priority", "3", "--ttl", "2h"});
  const std::string other = submit({"--owner", "bob", "--pin"});
  for (const std::string& job : {mine, other}) EXPECT_EQ(Call({"watch", job, "--json"}).exit_code, 0);
  json shown = json::parse(Call({"show", mine, "--json"}).out);
  EXPECT_NE(shown["owner"], "bob");
  EXPECT_EQ(shown["labels"]["study"], "left knee");
  EXPECT_EQ(shown["priority"], 3);
  EXPECT_EQ(shown["ttl_seconds"], 7200);
  EXPECT_EQ(
      Call({"update", mine, "--priority", "-1", "--label", "run=3", "--remove-label", "study", "--ttl", "0"}).exit_code,
      0);
  shown = json::parse(Call({"show", mine, "--json"}).out);
  EXPECT_EQ(shown["labels"], json::parse(R"({"run": "3"})"));
  EXPECT_EQ(shown["priority"], -1);
  EXPECT_FALSE(shown.contains("ttl_seconds"));
  EXPECT_EQ(Call({"update", mine}).exit_code, 2) << "nothing to change";
  EXPECT_EQ(Call({"update", mine, "--label", "none"}).exit_code, 2);
  EXPECT_EQ(Call({"update", mine, "--priority", "1000"}).exit_code, 2);

  const auto listed = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"list", "--json"});
    std::vector<std::string> names;
    for (const json& job : Lines(Call(options).out)) names.push_back(job["job"]);
    return names;
  };
  EXPECT_THAT(listed({"--filter", "labels.run=3 AND state=SUCCEEDED"}), ElementsAre(mine));
  EXPECT_THAT(listed({"--order-by", "priority"}), ElementsAre(mine, other));
  EXPECT_THAT(Call({"list"}).out, HasSubstr(" bob "));
  const Finished wrong = Call({"list", "--filter", "owner=bob AND colour=red"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err,
              AllOf(HasSubstr("filter: at character 15: there is no field colour"), HasSubstr("labels.KEY")));

  EXPECT_THAT(Call({"delete", "--filter", "state=SUCCEEDED", "--dry-run"}).out, HasSubstr("would delete " + mine));
  EXPECT_EQ(listed({}).size(), 2u);
  EXPECT_EQ(Call({"delete", "--filter", "state=SUCCEEDED AND age<1h"}).exit_code, 0);
  EXPECT_THAT(listed({}), ElementsAre(other)) << "it is pinned";
  EXPECT_EQ(Call({"delete"}).exit_code, 2);
  EXPECT_EQ(Call({"delete", other, "--filter", "owner=bob"}).exit_code, 2);
  EXPECT_EQ(Call({"delete", "--filter", "age>"}).exit_code, 2);
  const json info = json::parse(Call({"info", "--json"}).out);
  EXPECT_EQ(info["workers"], 2);
  EXPECT_EQ(info["max_queued_jobs_per_owner"], 10000);
  EXPECT_THAT(Call({"info"}).out, HasSubstr("queued"));
}

TEST_F(ServerTest, PausedJobsGoOnAndAWatchOfAllJobsTellsIt) {
  ChildProcess watch({Program("fascicle"), "--server", address_, "list", "--watch", "--json"});
  const std::string job = Submit(1000, 1000);
  const auto wait_for = [&](const std::string& state) {
    for (std::string line = watch.ReadLine(); !line.empty(); line = watch.ReadLine()) {
      const json told = json::parse(line);
      if (told.value("job", "") == job && told["state"] == state) return true;
    }
    return false;
  };
  ASSERT_TRUE(wait_for("running"));
  EXPECT_EQ(Call({"pause", job}).exit_code, 0);
  EXPECT_TRUE(wait_for("paused"));
  EXPECT_EQ(Call({"delete", job}).exit_code, 2);
  EXPECT_EQ(Call({"resume", job}).exit_code, 0);
  EXPECT_TRUE(wait_for("running"));
  EXPECT_EQ(Call({"cancel", job}).exit_code, 0);
  EXPECT_TRUE(wait_for("cancelled"));
  EXPECT_EQ(Call({"pause", job}).exit_code, 2);
  EXPECT_EQ(Call({"resume", job}).exit_code, 2);
  EXPECT_EQ(Call({"delete", job}).exit_code, 0);
  EXPECT_EQ(json::parse(watch.ReadLine())["removed"], job);
  watch.Signal(SIGINT);
  EXPECT_EQ(watch.Wait().exit_code, 4);
  for (const char* command : {"pause", "resume", "update"}) {
    std::vector<std::string> arguments = {command, "jobs/none"};
    if (arguments[0] == "update") arguments.emplace_back("--pin");
    EXPECT_EQ(Call(arguments).exit_code, 2) << command;
  }
}

TEST_F(ServerTest, CtrlCLeavesAWatchedJobRunning) {
  const std::string job = Submit(1000, 1000);
  ChildProcess watch({Program("fascicle"), "--server", address_, "watch", job});
  std::this_thread::sleep_for(std::chrono::milliseconds(1000));
  watch.Signal(SIGINT);
  const Finished finished = watch.Wait();
  EXPECT_EQ(finished.exit_code, 4);
  EXPECT_THAT(finished.err, HasSubstr("it continues"));
  EXPECT_EQ(json::parse(Call({"show", job, "--json"}).out)["state"], "running");
  EXPECT_EQ(Call({"cancel", job}).exit_code, 0);
}

// A watcher killed at frame k and restarted with --from k + 1 sees the same as one that was never killed.
TEST_F(ServerTest, AKilledWatcherGoesOnWithTheSameDigests) {
  const std::string job = Submit(30, 100);
  std::vector<std::string> seen;
  {
    ChildProcess watch({Program("fascicle"), "--server", address_, "watch", job, "--digests"});
    for (int i = 0; i < 7; ++i) seen.push_back(watch.ReadLine());
    watch.Signal(SIGKILL);
    EXPECT_EQ(watch.Wait().exit_code, -SIGKILL);
  }
  const auto append = [](const std::string& text, std::vector<std::string>& lines) {
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
      if (line.starts_with("frame ")) lines.push_back(line);
    }
  };
  append(Call({"watch", job, "--digests", "--from", "7"}).out, seen);
  std::vector<std::string> whole;
  append(Call({"watch", job, "--digests"}).out, whole);
  EXPECT_EQ(whole.size(), 31u);
  EXPECT_EQ(seen, whole);
}

}  // namespace
}  // namespace fascicle::testing
