// Every built-in example runs, and its result is what its description says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "example_fixture.h"
#include "tests/support/child_process.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace fascicle::testing {
namespace {

// bar_tension: BarTension.
std::string TestOf(const std::string& example) {
  std::string name;
  bool starts_word = true;
  for (const char c : example) {
    if (c != '_') name += starts_word ? static_cast<char>(std::toupper(c)) : c;
    starts_word = c == '_';
  }
  return name;
}

// Each example has a test of its name below, except for these.
TEST_F(ExampleTest, NoneIsForgotten) {
  std::set<std::string> tests;
  const ::testing::TestSuite& suite = *::testing::UnitTest::GetInstance()->current_test_suite();
  for (int i = 0; i < suite.total_test_count(); ++i) tests.insert(suite.GetTestInfo(i)->name());
  std::vector<std::string> without;
  std::istringstream list(RunProgram({Program("fascicle"), "examples", "--json"}).out);
  for (std::string line; std::getline(list, line);) {
    const std::string example = json::parse(line)["example"];
    if (!tests.contains(TestOf(example))) without.push_back(example);
  }
  EXPECT_THAT(without, ::testing::UnorderedElementsAre(
                           // PartsOfBodies
                           "bar_of_two_materials", "graded_bar", "let_go", "partial_recruitment", "two_compartments",
                           // examples_slow_test
                           "crushed_cube", "plastic_block",
                           // tests/verification/muscles_test.cc: a minute, or real anatomy
                           "fusiform_isometric", "biceps_isometric", "biceps_femoris_isometric", "biceps_tendon",
                           "triceps_tendon", "biceps_voxels"));
}

// The README shows it.
TEST_F(ExampleTest, FirstMuscle) {
  const std::string readme = ReadFile(ProjectRoot() / "README.md");
  const std::size_t begin = readme.find("```json") + 7;
  json example = json::parse(ReadFile(ProjectRoot() / "client/examples/first_muscle.json"), nullptr, true, true);
  example.erase("description");
  EXPECT_EQ(json::parse(readme.substr(begin, readme.find("```", begin) - begin)), example);
  const json summary = RunExample("first_muscle");
  EXPECT_NEAR(Final(summary, "muscle/reaction/insertion/z"), 26.93, 0.01 * 26.93);
  EXPECT_NEAR(Final(summary, "muscle/reaction/origin/z"), -Final(summary, "muscle/reaction/insertion/z"), 1e-4);
  EXPECT_GT(Final(summary, "muscle/min_volume_ratio"), 0.9);
  EXPECT_NEAR(Final(summary, "muscle/volume_ratio"), 1, 0.003);
}

// The springs stretch with the mean shortening of the end, which is somewhat less than that of its middle.
TEST_F(ExampleTest, PressedMuscle) {
  const std::string out = folder_ / "out";
  RunExample("pressed_muscle", {"--out", out});
  const std::vector<double> force = SeriesOf(folder_ / "out/series.csv", "muscle/reaction/origin/z");
  const std::vector<double> shortening = SeriesOf(folder_ / "out/series.csv", "probe/insertion/z");
  ASSERT_EQ(force.size(), 5u);
  for (const int frame : {1, 2, 3, 4}) {
    EXPECT_LT(force[frame] / (2000 * shortening[frame]), 1) << frame;
    EXPECT_GT(force[frame] / (2000 * shortening[frame]), 0.9) << frame;
  }
  EXPECT_LT(std::abs(force[4]), 0.95 * std::abs(force[2])) << "the cuff";
}

TEST_F(ExampleTest, VoxelCantilever) {
  const json summary = RunExample("voxel_cantilever");
  // F L^3 / (3 E I) + F L / (5/6 G A), less about 1 % for the clamped end and 16 bricks across.
  const double beam =
      10 * std::pow(0.08, 3) / (3 * 1e9 * std::pow(0.01, 4) / 12) + 10 * 0.08 / (5.0 / 6 * 1e9 / 2.6 * 1e-4);
  EXPECT_NEAR(Final(summary, "probe/tip/z"), -beam, 0.015 * beam);
  EXPECT_NEAR(Final(summary, "beam/reaction/wall/z"), 10, 1e-5);
}

// The same block of tetrahedra (quadratic, quasi-static) sinks by 1.269 mm.
TEST_F(ExampleTest, HangingBlock) {
  const json summary = RunExample("hanging_block");
  EXPECT_NEAR(Final(summary, "probe/bottom/z"), -1.269e-3, 0.03 * 1.269e-3);
  EXPECT_NEAR(Final(summary, "block/reaction/top/z"), 8, 0.02 * 8);
  EXPECT_NEAR(Final(summary, "block/volume_ratio"), 1.0063, 6e-4);
}

// The same block of tetrahedra (quadratic, quasi-static) shortens by 25.11 mm.
TEST_F(ExampleTest, ActiveBlock) {
  const json summary = RunExample("active_block");
  EXPECT_NEAR(Final(summary, "probe/end/x"), -25.11e-3, 0.03 * 25.11e-3);
  EXPECT_NEAR(Final(summary, "muscle/reaction/origin/x"), 0, 0.01);
  EXPECT_NEAR(Final(summary, "muscle/volume_ratio"), 1, 3e-3);
}

TEST_F(ExampleTest, BallSwings) {
  const json summary = RunExample("ball_swings");
  EXPECT_NEAR(Final(summary, "probe/bottom/x"), 0.03, 1e-3);
  EXPECT_GT(summary["series"]["probe/bottom/x"]["max"], 0.031) << "it swings beyond";
  EXPECT_NEAR(Final(summary, "ball/reaction/top/z"), 1000 * 2.59e-4 * 9.81, 0.1);
  EXPECT_GT(summary["series"]["ball/volume_ratio"]["min"], 0.997);
  EXPECT_LT(summary["series"]["ball/volume_ratio"]["max"], 1.003);
}

TEST_F(ExampleTest, AnconeusLoads) {
  const std::string out = folder_ / "out";
  const json summary = RunExample("anconeus_loads", {"--out", out});
  const std::vector<double> x = SeriesOf(folder_ / "out/series.csv", "probe/upper/y");
  ASSERT_EQ(x.size(), 5u);
  EXPECT_EQ(x[0], 0);
  for (std::size_t f = 2; f < 5; ++f) EXPECT_NEAR(x[f] / x[1], static_cast<double>(f), 1e-5);
  EXPECT_GT(x[4], 0.001);
  EXPECT_NEAR(Final(summary, "anconeus/reaction/lower/y"), -1000, 0.01);
  EXPECT_NEAR(Final(summary, "anconeus/reaction/lower/x"), 0, 0.01);
}

TEST_F(ExampleTest, AnconeusRelease) {
  const std::string out = folder_ / "out";
  RunExample("anconeus_release", {"--out", out});
  const std::vector<double> x = SeriesOf(folder_ / "out/series.csv", "probe/upper/x");
  ASSERT_EQ(x.size(), 23u);
  // Turning points and passages through the rest position.
  std::vector<double> peaks = {x[0]};
  for (std::size_t f = 1; f + 1 < x.size(); ++f) {
    if ((x[f] - x[f - 1]) * (x[f + 1] - x[f]) < 0) peaks.push_back(x[f]);
  }
  ASSERT_GE(peaks.size(), 3u);
  for (std::size_t k = 1; k < peaks.size(); ++k) {
    EXPECT_LT(peaks[k] * peaks[k - 1], 0);
    EXPECT_LT(std::abs(peaks[k]), std::abs(peaks[k - 1]));
  }
}

TEST_F(ExampleTest, AnconeusStern) {
  const std::string out = folder_ / "out";
  RunExample("anconeus_stern", {"--out", out});
  const std::vector<double> pull = SeriesOf(folder_ / "out/series.csv", "anconeus/load/0/upper");
  const std::vector<double> held = SeriesOf(folder_ / "out/series.csv", "anconeus/reaction/lower/y");
  ASSERT_EQ(pull.size(), 21u);
  EXPECT_EQ(pull[0], 0);
  EXPECT_GT(pull[4], 100);      // isometric at 0.08 s
  EXPECT_LT(pull[8], pull[4]);  // shortening at 0.16 s
  EXPECT_GT(pull[8], 0);
  for (std::size_t f = 0; f < pull.size(); ++f) EXPECT_NEAR(held[f], -pull[f] / std::hypot(0.2, 1), 0.01);
}

TEST_F(ExampleTest, BarTension) {
  const json summary = RunExample("bar_tension");
  const double stretch = 1 + Final(summary, "probe/end/x") / 0.04;
  EXPECT_NEAR(NominalStress("neo_hookean", {"young_modulus=1e4"}, stretch), 2000, 20);
  EXPECT_NEAR(Final(summary, "bar/reaction/left/x"), -0.2, 0.001);
}

TEST_F(ExampleTest, BarTwist) {
  const json summary = RunExample("bar_twist");
  EXPECT_NEAR(Final(summary, "probe/corner/x"), -0.02, 1e-9);
  EXPECT_NEAR(Final(summary, "probe/corner/y"), 0, 1e-9);
  EXPECT_NEAR(Final(summary, "probe/axis/x"), 0, 1e-4);
  EXPECT_NEAR(Final(summary, "probe/axis/y"), 0, 1e-4);
}

// FEBio's finest mesh of hexahedra with three fields bends by 5.534 mm.
TEST_F(ExampleTest, RubberBending) {
  const json summary = RunExample("rubber_bending");
  EXPECT_NEAR(Final(summary, "probe/tip/z"), -5.534e-3, 0.025 * 5.534e-3);
  EXPECT_NEAR(Final(summary, "beam/reaction/wall/z"), 5e-4, 1e-9);
  EXPECT_NEAR(Final(summary, "beam/volume_ratio"), 1, 1e-4);
}

TEST_F(ExampleTest, FusiformQuasiStatic) {
  const json summary = RunExample("fusiform_quasi_static");
  const double force = Final(summary, "muscle/reaction/insertion/z");
  EXPECT_NEAR(Final(summary, "muscle/reaction/origin/z"), -force, 1e-6 * force);
  // Peak stress times the area of the ends, 0.3 MPa pi 36 mm^2 = 34 N, bounds it from below, and times that of the
  // belly, 185 N, from above.
  EXPECT_GT(force, 34);
  EXPECT_LT(force, 185);
  EXPECT_NEAR(Final(summary, "muscle/volume_ratio"), 1, 0.01);
}

TEST_F(ExampleTest, CantileverGravity) {
  const json summary = RunExample("cantilever_gravity");
  EXPECT_NEAR(Final(summary, "beam/reaction/wall/z"), 1026 * 9.81 * 0.04 * 0.0125 * 0.0125, 1e-4);
  // Beam theory, less up to 15 % for the stiffness of linear tetrahedra.
  const double theory = 1.5 * 1026 * 9.81 * std::pow(0.04, 4) / (4e5 * 0.0125 * 0.0125);
  EXPECT_LT(-Final(summary, "probe/tip/z"), theory);
  EXPECT_GT(-Final(summary, "probe/tip/z"), 0.85 * theory);
}

TEST_F(ExampleTest, FusiformBipennate) {
  const json summary = RunExample("fusiform_bipennate");
  const double pull = Final(summary, "muscle/reaction/insertion/z");
  EXPECT_GT(pull, 1);
  EXPECT_LT(std::abs(Final(summary, "muscle/reaction/insertion/x")), 0.001 * pull);

  const json leaning =
      RunWithFibres("fusiform_bipennate", [](json& fibres) { fibres["pennation"].erase("mirror_point"); });
  EXPECT_GT(std::abs(Final(leaning, "muscle/reaction/insertion/x")), 0.02 * pull);
  const json parallel = RunWithFibres("fusiform_bipennate", [](json& fibres) { fibres.erase("pennation"); });
  EXPECT_LT(pull, 0.85 * Final(parallel, "muscle/reaction/insertion/z"));
}

// The force of a body at its insertion, which follows the forearm, and its torque about the elbow.
void ExpectTorqueIsForceTimesArm(const json& summary, const std::string& body, double tolerance) {
  const auto final = [&](const std::string& series) { return summary["series"].at(series)["final"].get<double>(); };
  const auto along = [&](const char* axis) { return final(body + "/reaction/line/" + axis); };
  const double force = std::hypot(along("x"), along("y"), along("z"));
  const double torque = force * final("skeleton/" + body + "_line/moment_arm/elbow");
  EXPECT_NEAR(final("skeleton/elbow/torque/" + body), torque, tolerance * std::abs(torque)) << body;
}

TEST_F(ExampleTest, UpperArmIsometric) {
  const json summary = RunExample("upper_arm_isometric");
  for (const std::string body : {"biceps", "triceps"}) {
    const double pull = Final(summary, body + "/reaction/origin/y");
    EXPECT_GT(pull, body == "biceps" ? 50 : 10) << body;
    for (const char* axis : {"x", "y", "z"}) {
      EXPECT_NEAR(Final(summary, body + "/reaction/origin/" + axis), -Final(summary, body + "/reaction/line/" + axis),
                  0.01 * pull);
    }
    ExpectTorqueIsForceTimesArm(summary, body, 0.05);
  }
  EXPECT_GT(Final(summary, "skeleton/elbow/torque/biceps"), 0);
  EXPECT_LT(Final(summary, "skeleton/elbow/torque/triceps"), 0);
}

TEST_F(ExampleTest, UpperArm) {
  const json summary = RunExample("upper_arm");
  EXPECT_NEAR(Final(summary, "skeleton/elbow/angle"), 1.5, 1e-12);
  const double needed = Final(summary, "skeleton/elbow/torque");
  EXPECT_NEAR(Final(summary, "skeleton/elbow/muscle_torque"), needed, 1e-6 * needed);
  EXPECT_NEAR(Final(summary, "biceps/activation"), Final(summary, "biceps_line/activation"), 1e-12);
  ExpectTorqueIsForceTimesArm(summary, "biceps", 0.15);
  ExpectTorqueIsForceTimesArm(summary, "triceps", 0.15);
  EXPECT_FALSE(summary.contains("notes")) << summary["notes"];
}

TEST_F(ExampleTest, FusiformBspline) {
  const json summary = RunExample("fusiform_bspline");
  const double pull = Final(summary, "muscle/reaction/insertion/z");
  EXPECT_GT(pull, 1);
  EXPECT_NEAR(Final(summary, "muscle/reaction/origin/z"), -pull, 0.01 * pull);
  EXPECT_GT(Final(summary, "probe/belly/x"), 0);
  const json harmonic = RunWithFibres("fusiform_bspline", [](json& fibres) {
    fibres = {{"harmonic", {{"origin", "origin"}, {"insertion", "insertion"}}}};
  });
  EXPECT_NEAR(pull, Final(harmonic, "muscle/reaction/insertion/z"), 0.1 * pull);
}

TEST_F(ExampleTest, MeshFile) {
  const json summary = RunExample("mesh_file");
  const double pull = Final(summary, "strip/reaction/insertion/z");
  EXPECT_GT(pull, 1);
  EXPECT_NEAR(Final(summary, "strip/reaction/origin/z"), -pull, 0.01 * pull);
  EXPECT_NEAR(Final(summary, "strip/activation"), 1, 1e-12);
}

TEST_F(ExampleTest, MuscleLifts) {
  const json summary = RunExample("muscle_lifts");
  EXPECT_NEAR(Final(summary, "block/reaction/left/x"), -1, 0.01);
  EXPECT_GT(summary["series"]["probe/end/x"]["max"], 0.002) << "the load lengthens it";
  EXPECT_LT(Final(summary, "probe/end/x"), -0.002) << "then it shortens";
  EXPECT_GT(summary["series"]["solver/iterations"]["max"], 0) << "mixed stepping solves";
}

TEST_F(ExampleTest, RubberStretch) {
  const json summary = RunExample("rubber_stretch");
  const double stress = NominalStress("mooney_rivlin", {"c1=2000", "c2=500", "bulk_modulus=2.5e5"}, 1.5);
  EXPECT_NEAR(Final(summary, "rubber/reaction/left/x"), -stress * 1e-4, 0.001 * stress * 1e-4);
  EXPECT_NEAR(Final(summary, "rubber/volume_ratio"), 1.01, 0.005);
}

TEST_F(ExampleTest, SphereHanging) {
  const json summary = RunExample("sphere_hanging");
  const double round = 1060 * 9.81 * 4 / 3 * M_PI * 8e-6;
  EXPECT_LT(Final(summary, "ball/reaction/top/z"), round);
  EXPECT_GT(Final(summary, "ball/reaction/top/z"), 0.9 * round);
}

TEST_F(ExampleTest, TendonPull) {
  const json summary = RunExample("tendon_pull");
  const double force = NominalStress("tendon", {"bulk_modulus=2e7"}, 1.02) * 25e-6;
  EXPECT_NEAR(Final(summary, "tendon/reaction/left/x"), -force, 0.01 * force);
}

TEST_F(ExampleTest, TorusRinging) {
  RunExample("torus_ringing", {"--out", folder_ / "out"});
  std::istringstream csv(ReadFile(folder_ / "out/series.csv"));
  std::string line;
  std::getline(csv, line);
  ASSERT_TRUE(line.starts_with("frame,time [s],step,energy/elastic [J],energy/kinetic [J]")) << line;
  double lowest = INFINITY, highest = 0;
  while (std::getline(csv, line)) {
    double frame, time, step, elastic, kinetic;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf", &frame, &time, &step, &elastic, &kinetic), 5);
    if (time < 0.11) continue;  // the force still does work
    lowest = std::min(lowest, elastic + kinetic);
    highest = std::max(highest, elastic + kinetic);
  }
  EXPECT_GT(lowest, 0);
  EXPECT_LT(highest / lowest, 1.01);
}

TEST_F(ExampleTest, TorusBounce) {
  const json summary = RunExample("torus_bounce", {"--out", folder_ / "out"});
  std::istringstream csv(ReadFile(folder_ / "out/series.csv"));
  std::string line;
  std::getline(csv, line);
  const auto column = [header = line](const std::string& name) {
    const std::size_t at = header.find(name);
    EXPECT_NE(at, std::string::npos) << name;
    return std::count(header.begin(), header.begin() + static_cast<std::ptrdiff_t>(at), ',');
  };
  const auto elastic = column("energy/elastic"), kinetic = column("energy/kinetic"),
             work = column("energy/external_work"), contact = column("energy/contact"), push = column("floor/ground/y"),
             top = column("probe/top/y");
  const double fall = 0.05, weight = 1000 * 2 * M_PI * M_PI * 0.025 * 1e-4 * 9.81;
  double most_work = 0, after_bounce = 0, impulse = 0, touching = 0;
  while (std::getline(csv, line)) {
    std::vector<double> values;
    std::istringstream in(line);
    for (std::string value; std::getline(in, value, ',');) values.push_back(std::stod(value));
    const double time = values[1];
    // It falls freely before it touches the floor.
    if (time < 0.1) {
      EXPECT_NEAR(values[top], -0.5 * 9.81 * time * time, 1e-6);
    }
    most_work = std::max(most_work, values[work]);
    EXPECT_NEAR(values[elastic] + values[kinetic] + values[contact] - values[work], 0, 0.01 * weight * fall) << time;
    if (time > 0.2) after_bounce = std::max(after_bounce, most_work - values[work]);
    if (time > 0.1) impulse += values[push], touching += 1;
  }
  EXPECT_GT(most_work, 1.1 * weight * fall) << "it flattens";
  EXPECT_GT(after_bounce, 0.4 * weight * fall) << "it comes up again";
  EXPECT_NEAR(impulse / touching, weight, 0.3 * weight);
}

// Nothing moves before the load ends, from the first frame on.
TEST_F(ExampleTest, ReleasedBar) {
  RunExample("released_bar", {"--out", folder_ / "out"});
  const std::vector<double> end = SeriesOf(folder_ / "out/series.csv", "probe/end/z");
  ASSERT_EQ(end.size(), 51u);
  EXPECT_NEAR(end[0], -0.009, 0.001);
  for (int frame = 1; frame <= 10; ++frame) EXPECT_NEAR(end[frame], end[0], 1e-9);
  EXPECT_GT(*std::max_element(end.begin(), end.end()), 0);
}

TEST_F(ExampleTest, Twitch) {
  const json summary = RunExample("twitch");
  EXPECT_NEAR(Final(summary, "strip/activation"), 0.8, 1e-4);
  EXPECT_LT(Final(summary, "strip/reaction/left/x"), 0);
}

// Written with their files, and valid.
TEST_F(ExampleTest, PartsOfBodiesAreValid) {
  for (const std::string name :
       {"bar_of_two_materials", "graded_bar", "two_compartments", "partial_recruitment", "let_go"}) {
    RunProgram({Program("fascicle"), "examples", "write", name, "--out", folder_.path().string()});
    const Finished finished = RunProgram({Program("fascicle"), "validate", folder_ / (name + ".json")});
    EXPECT_EQ(finished.exit_code, 0) << finished.out << finished.err;
  }
}

}  // namespace
}  // namespace fascicle::testing
