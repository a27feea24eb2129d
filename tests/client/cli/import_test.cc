// `fascicle import` as users see it; results of imported scenes agree with FEBio's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "fascicle_fixture.h"
#include "tests/support/feb_writer.h"
#include "tests/support/reference_file.h"

namespace fascicle::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

// Problem b with symmetry planes: 10 mm, stretched by half.
FebWriter StretchedCube(const std::string& version) {
  FebWriter feb(version, Box(Vec3(10, 10, 10), {2, 2, 2}));
  const char* names[] = {"x0", "y0", "z0"};
  for (int axis = 0; axis < 3; ++axis) {
    feb.AddNodeSet(names[axis], feb.Nodes([axis](const Point& x) { return x[static_cast<std::size_t>(axis)] == 0; }));
    feb.Fix(names[axis], std::string(1, "xyz"[axis]));
  }
  feb.AddNodeSet("top", feb.Nodes([](const Point& x) { return x[2] == 10; }));
  feb.Move("top", 'z', 5);
  feb.SetMaterial("Mooney-Rivlin", "      <c1>0.03</c1><c2>0.01</c2><k>80</k>\n");
  return feb;
}

class ImportCommandTest : public FascicleTest {
 protected:
  std::string Model(const std::string& text) const { return File("model.feb", text); }
};

// The last value of a series in the summary of `run --json`.
double LastOf(const json& summary, const std::string& series) {
  const json& all = summary.at("series");
  EXPECT_TRUE(all.contains(series)) << all.dump();
  return all.contains(series) ? all.at(series).at("final").get<double>() : 0;
}

TEST_F(ImportCommandTest, ImportedCubesPullAsInFebio) {
  for (const char* version : {"4.0", "3.0", "2.5"}) {
    const std::string out = folder_ / ("cube" + std::string(version));
    const Finished imported = Fascicle({"import", Model(StretchedCube(version).Model()), "--out", out});
    ASSERT_EQ(imported.exit_code, 0) << imported.err;
    EXPECT_THAT(imported.out, HasSubstr("model.feb (FEBio " + std::string(version) + ", units mm-N-s)"));
    const Finished valid = Fascicle({"validate", out + "/scene.json"});
    EXPECT_EQ(valid.exit_code, 0) << valid.err;
    const Finished run = Fascicle({"run", out + "/scene.json", "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const double force = LastOf(json::parse(run.out), "belly/reaction/top/z");
    std::printf("b homogeneous, FEBio %s: force %.8g N, FEBio's 7.7368966 N\n", version, force);
    EXPECT_NEAR(force, 7.7368966, 1e-6 * 7.7368966);
  }
}

// Problem a on FEBio's own mesh of ten-node tetrahedra.
TEST_F(ImportCommandTest, ImportedCantileverBendsAsInFebio) {
  const auto problem = ReadReference("a_cantilever_neohookean");
  if (!problem) GTEST_SKIP() << "no reference results in " << ReferenceFolder() << " (set FASCICLE_REFERENCE)";
  FebWriter feb("4.0", MeshOf(problem->at("full_fields_coarsest_mesh").at("tet10")));
  feb.AddNodeSet("root", feb.Nodes([](const Point& x) { return x[0] == 0; }));
  feb.Fix("root", "xyz");
  feb.AddSurface("tip", "tri6", Facets(feb.mesh(), [](const Point& x) { return x[0] == 10; }));
  feb.AddLoad(
      "<surface_load type=\"traction\" surface=\"tip\"><scale lc=\"1\">1</scale><traction>0,0,-1</traction>"
      "<linear>1</linear></surface_load>");
  feb.SetMaterial("neo-Hookean", "      <E>1000</E><v>0.3</v>\n");
  const std::string out = folder_ / "beam";
  const Finished imported = Fascicle({"import", Model(feb.Model()), "--out", out});
  ASSERT_EQ(imported.exit_code, 0) << imported.err;
  const Finished run =
      Fascicle({"run", out + "/scene.json", "--json", "--set",
                "output.probes=[{\"name\": \"tip\", \"body\": \"belly\", \"point\": [10, 0.5, 0.5]}]"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  double expected = 0;
  for (const json& result : problem->at("runs")) {
    if (result.at("name") == "a_tet10_20") expected = result.at("tip_center_displacement")[2].get<double>();
  }
  const double tip = 1e3 * LastOf(json::parse(run.out), "probe/tip/z");
  std::printf("a, tet10 20x2x2: tip %.6g mm, FEBio's %.6g mm\n", tip, expected);
  EXPECT_NEAR(tip, expected, 1e-3 * std::abs(expected));
}

TEST_F(ImportCommandTest, WhatChangesTheAnswerStopsUnlessItIsAccepted) {
  std::string text = StretchedCube("4.0").Model();
  text.insert(text.find("  <Output>"), "  <Contact><contact name=\"c1\" type=\"sliding-elastic\"/></Contact>\n");
  const auto line =
      std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find("  <Contact>")), '\n') + 1;
  const std::string where = "model.feb:" + std::to_string(line) + ": Contact";
  const std::string out = folder_ / "out";
  const Finished refused = Fascicle({"import", Model(text), "--out", out});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr(where + ": not supported"));
  EXPECT_THAT(refused.err, HasSubstr("or import without it by --accept-loss"));
  EXPECT_FALSE(fs::exists(out));
  const Finished lenient = Fascicle({"import", Model(text), "--out", out, "--accept-loss"});
  EXPECT_EQ(lenient.exit_code, 0);
  EXPECT_THAT(lenient.out, HasSubstr("not supported:\n  " + where));
  EXPECT_TRUE(fs::exists(out + "/scene.json"));
  const Finished as_json = Fascicle({"import", Model(text), "--out", out, "--accept-loss", "--json"});
  const json summary = json::parse(as_json.out);
  EXPECT_EQ(summary.at("units"), "mm-N-s");
  EXPECT_EQ(summary.at("notices").back().at("kind"), "not_taken");
  EXPECT_EQ(summary.at("notices").back().at("line"), line);
}

TEST_F(ImportCommandTest, MistakesAreToldAndNothingIsWritten) {
  std::string text = StretchedCube("4.0").Model();
  text.replace(text.find("<c1>0.03"), 8, "<c1>much");
  text.replace(text.find("mat=\"tissue\""), 12, "mat=\"stone\"");
  const std::string out = folder_ / "out";
  const Finished failed = Fascicle({"import", Model(text), "--out", out});
  EXPECT_EQ(failed.exit_code, 2);
  EXPECT_THAT(failed.err, HasSubstr("Material/material `tissue`/c1: `much` is not a number"));
  EXPECT_THAT(failed.err, HasSubstr("there is no material `stone` (materials of the model: `tissue`)"));
  EXPECT_FALSE(fs::exists(out));
  EXPECT_EQ(Fascicle({"import", folder_ / "none.feb", "--out", out}).exit_code, 2);
}

}  // namespace
}  // namespace fascicle::testing
