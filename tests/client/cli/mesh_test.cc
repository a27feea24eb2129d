// `fascicle mesh` as users see it: from surfaces and label images to meshes and scenes that run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "fascicle_fixture.h"

namespace fascicle::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string Muscle(const std::string& name) {
  return testing::DataFolder() / "vh_muscle_surfaces" / ("VHM_Left_" + name + "_4k.stl");
}

// A bar of 20 x 20 x 60 along z, as OBJ.
constexpr const char* kBar = R"(v 0 0 0
v 20 0 0
v 20 20 0
v 0 20 0
v 0 0 60
v 20 0 60
v 20 20 60
v 0 20 60
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
)";

using MeshTest = FascicleTest;

TEST_F(MeshTest, TellsAboutTheMesh) {
  const std::string bar = File("bar.obj", kBar);
  const Finished made = Fascicle({"mesh", bar, "--out", folder_ / "bar.msh", "--size", "5", "--picture",
                                  folder_ / "bar.png", "--region", "top=side:0,0,1:10"});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, AllOf(HasSubstr("tetrahedra"), HasSubstr("dihedral angles"), HasSubstr("of the surface's"),
                              HasSubstr("region top"), HasSubstr("physical tag 1")));
  EXPECT_TRUE(HasFile("bar.msh"));
  EXPECT_EQ(ReadFile(folder_ / "bar.png").substr(1, 3), "PNG");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path())) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path();
  }
}

// Minutes of work without the signal.
TEST_F(MeshTest, CtrlCStopsItWithoutAFile) {
  const std::string bar = File("bar.obj", kBar);
  const std::set<std::string> before = Files();
  ChildProcess child({Program("fascicle"), "mesh", bar, "--out", folder_ / "bar.msh", "--tets", "20000000"});
  ASSERT_TRUE(child.AwaitBlocked(SIGINT));
  child.Signal(SIGINT);
  const Finished finished = child.Wait();
  EXPECT_EQ(finished.exit_code, 4) << finished.err;
  EXPECT_THAT(finished.err, HasSubstr("interrupted"));
  EXPECT_EQ(Files(), before);
}

TEST_F(MeshTest, TheSameMeshForAnyNumberOfThreads) {
  const std::string bar = File("bar.obj", kBar);
  EXPECT_EQ(Fascicle({"mesh", bar, "--out", folder_ / "a.msh", "--tets", "2000", "--threads", "1"}).exit_code, 0);
  EXPECT_EQ(Fascicle({"mesh", bar, "--out", folder_ / "b.msh", "--tets", "2000", "--threads", "3"}).exit_code, 0);
  EXPECT_EQ(ReadFile(folder_ / "a.msh"), ReadFile(folder_ / "b.msh"));
}

TEST_F(MeshTest, TellsAllMistakesAtOnceAndWritesNothing) {
  const std::string bar = File("bar.obj", kBar);
  const Finished wrong = Fascicle({"mesh",
                                   bar,
                                   "--json",
                                   "--out",
                                   folder_ / "bar.vtk",
                                   "--label",
                                   "1",
                                   "--region",
                                   "a b=side:0,0,1",
                                   "--region",
                                   "c=side:0,0",
                                   "--region",
                                   "d=near:none.stl:3",
                                   "--region",
                                   "e=near:" + bar,
                                   "--region",
                                   "f",
                                   "--region",
                                   "g=ball:1",
                                   "--region",
                                   "g=side:0,0,1:200",
                                   "--region",
                                   "h=end:0,0,0:3",
                                   "--region",
                                   "i=end:0,0,1:0",
                                   "--region",
                                   "j=end:0,0,1"});
  EXPECT_EQ(wrong.exit_code, 2);
  const json error = json::parse(wrong.out);
  EXPECT_EQ(error["reason"], "INVALID_SURFACE");
  std::vector<std::string> paths;
  for (const json& problem : error["problems"]) paths.push_back(problem["path"]);
  EXPECT_THAT(paths, ::testing::UnorderedElementsAre("--out", "--label", "--region a b", "--region c", "--region d",
                                                     "--region e", "--region f", "--region g", "--region g",
                                                     "--region g", "--region h", "--region i", "--region j"));
  EXPECT_EQ(Fascicle({"mesh", folder_ / "none.stl", "--out", folder_ / "x.msh"}).exit_code, 2);
  EXPECT_EQ(Fascicle({"mesh", bar, "--out", folder_ / "x.msh", "--size", "2", "--tets", "3000"}).exit_code, 2);
  EXPECT_EQ(Fascicle({"mesh", bar, "--out", folder_ / "x.msh", "--size", "-2"}).exit_code, 2);
  EXPECT_FALSE(HasFile("x.msh") || HasFile("bar.vtk"));
}

TEST_F(MeshTest, AnEmptyRegionIsAMistake) {
  const std::string bar = File("bar.obj", kBar);
  const std::string far = File("far.obj", "v 0 0 100\nv 20 0 100\nv 0 20 100\nf 1 2 3\n");
  const Finished wrong =
      Fascicle({"mesh", bar, "--out", folder_ / "bar.msh", "--size", "5", "--region", "top=near:" + far + ":3"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, AllOf(HasSubstr("--region top: selects no triangle"), HasSubstr("the nearest triangle is 4"),
                               HasSubstr("in the same unit")));
  EXPECT_FALSE(HasFile("bar.msh"));
}

TEST_F(MeshTest, TheEndsOfAMuscleMustBeApart) {
  const std::string bar = File("bar.obj", kBar);
  const auto with_ends = [&](const std::string& origin, const std::string& insertion) {
    return Fascicle({"mesh", bar, "--json", "--out", folder_ / "bar.msh", "--size", "5", "--scene",
                     folder_ / "bar.json", "--region", "origin=" + origin, "--region", "insertion=" + insertion});
  };
  const Finished wrong = with_ends("end:0,0,2:35", "end:0,0,-1:35");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err + wrong.out, AllOf(HasSubstr("--region insertion"), HasSubstr("nodes in common with origin")));
  EXPECT_FALSE(HasFile("bar.msh"));
  const Finished right = with_ends("end:0,0,2:12", "end:0,0,-1:0.1");
  ASSERT_EQ(right.exit_code, 0) << right.err;
  const json regions = json::parse(right.out)["regions"];
  // The face and a rim of 10 to 12 around it; the face alone.
  EXPECT_GT(regions[0]["area"], 400 + 80 * 10 - 1);
  EXPECT_LT(regions[0]["area"], 400 + 80 * 12 + 1);
  EXPECT_NEAR(regions[1]["area"].get<double>(), 400, 1);
}

TEST_F(MeshTest, AHoleIsRefusedWithItsPlace) {
  std::string open = kBar;
  open.erase(open.find("f 5 6 7 8\n"), 10);
  const Finished refused = Fascicle({"mesh", File("open.obj", open), "--out", folder_ / "open.msh"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr("open.obj: the surface has a hole at (10, 10, 60), 28.3 across"), HasSubstr("80 long")));
  const Finished closed =
      Fascicle({"mesh", folder_ / "open.obj", "--out", folder_ / "open.msh", "--size", "5", "--max-hole", "30"});
  EXPECT_EQ(closed.exit_code, 0) << closed.err;
  EXPECT_THAT(closed.out, HasSubstr("closed a hole at (10, 10, 60)"));
}

TEST_F(MeshTest, AMuscleIsMeshedWithItsAttachmentsAndContracts) {
  if (!fs::exists(Muscle("Muscle_PeroneusLongus"))) GTEST_SKIP() << DataFolder() << " is not there; set FASCICLE_DATA";
  const Finished made =
      Fascicle({"mesh", Muscle("Muscle_PeroneusLongus"), "--json", "--out", folder_ / "m/peroneus.msh", "--tets",
                "3000", "--region", "origin=end:0,0,1:40", "--region", "insertion=end:0,0,-1:25", "--region",
                "fibula=near:" + Muscle("Bone_Fibula") + ":6", "--scene", folder_ / "scene.json"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const json report = json::parse(made.out);
  EXPECT_GE(report["smallest_dihedral_angle"], 10.0);
  EXPECT_NEAR(report["volume_error"].get<double>(), 0, 5e-3);
  EXPECT_GT(report["regions"][2]["triangles"], 10);

  const Finished run = Fascicle({"run", folder_ / "scene.json", "--json", "--out", folder_ / "out"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json series = json::parse(ReadFile(folder_ / "out/summary.json"))["series"];
  const auto last = [&](const char* name) { return series.at(name).at("final").get<double>(); };
  EXPECT_NEAR(last("muscle/volume_ratio"), 1, 0.01);
  EXPECT_GT(last("muscle/min_volume_ratio"), 0.2);
  // The muscle pulls its insertion, at the lower end, upwards; the support there pulls down with some tens of newtons.
  EXPECT_LT(last("muscle/reaction/insertion/z"), -5);
  for (const std::string axis : {"x", "y", "z"}) {
    EXPECT_NEAR(last(("muscle/reaction/origin/" + axis).c_str()), -last(("muscle/reaction/insertion/" + axis).c_str()),
                1e-3);
  }
}

TEST_F(MeshTest, LabelsOfAnImage) {
  const fs::path image = DataFolder() / "voxel_labels/upper_arm_biceps1_triceps2_1mm.mha";
  if (!fs::exists(image)) GTEST_SKIP() << image << " is not there; set FASCICLE_DATA";
  const Finished made =
      Fascicle({"mesh", image, "--label", "1", "--json", "--out", folder_ / "biceps.msh", "--tets", "4000"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const json report = json::parse(made.out);
  EXPECT_NEAR(report["volume"].get<double>() / report["voxel_volume"].get<double>(), 1, 5e-3);
  EXPECT_GE(report["smallest_dihedral_angle"], 10.0);
  // The surface encloses 317 cm^3; the voxels that it touches have 8 % more.
  EXPECT_NEAR(report["volume"].get<double>() / 317e3, 1.08, 0.03);
  const Finished wrong = Fascicle({"mesh", image, "--label", "7", "--out", folder_ / "x.msh"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("no voxel has the label 7 (existing labels: 1, 2)"));
  EXPECT_EQ(Fascicle({"mesh", image, "--out", folder_ / "x.msh"}).exit_code, 2) << "without a label";
}

// A bar of two hexahedra with sets of all kinds.
constexpr const char* kAbaqus = R"(*NODE
1,0,0,0
2,20,0,0
3,20,20,0
4,0,20,0
5,0,0,30
6,20,0,30
7,20,20,30
8,0,20,30
9,0,0,60
10,20,0,60
11,20,20,60
12,0,20,60
*ELEMENT, TYPE=C3D8, ELSET=belly
1,1,2,3,4,5,6,7,8
*ELEMENT, TYPE=C3D8, ELSET=tendon
2,5,6,7,8,9,10,11,12
*ELSET, ELSET=whole
belly, tendon
*SURFACE, NAME=origin
belly, S1
*SURFACE, NAME=insertion
tendon, S2
*NSET, NSET=corner
1
)";

TEST_F(MeshTest, ConvertsMeshesWithTheirSets) {
  const std::string model = File("bar.inp", kAbaqus);
  const Finished kept = Fascicle({"mesh", model, "--convert", "--out", folder_ / "bar.msh"});
  ASSERT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_THAT(kept.out, AllOf(HasSubstr("hexahedra           2\n"), HasSubstr("1 hexahedra, 1.2e+04 mm^3"),
                              HasSubstr("volume              24000 mm^3")));
  const std::vector<std::string> convert = {
      "mesh", model, "--convert", "--split-hexahedra", "--out", folder_ / "bar.msh"};
  const Finished made = Fascicle(convert);
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, AllOf(HasSubstr("note: 2 hexahedra were split into tetrahedra"),
                              HasSubstr("volume              24000 mm^3"),
                              HasSubstr("region origin       physical tag 5: 2 triangles, 400 mm^2"),
                              HasSubstr("6 tetrahedra, 1.2e+04 mm^3"), HasSubstr("1 nodes")));
  EXPECT_THAT(ReadFile(folder_ / "bar.msh"), HasSubstr("$PhysicalNames\n6\n3 1 \"belly\"\n"));
  std::vector<std::string> as_json = convert;
  as_json.push_back("--json");
  const json report = json::parse(Fascicle(as_json).out);
  EXPECT_EQ(report["tetrahedra"], 12);
  EXPECT_EQ(report["regions"].size(), 6u);

  // A scene with these tags.
  const std::string scene = File("scene.json", R"({"name": "bar", "bodies": [{"name": "bar", "unit": "mm",
    "mesh": {"file": {"path": "bar.msh"}}, "material": {"neo_hookean": {"young_modulus": 1e5}},
    "regions": [{"name": "origin", "physical_tag": 5}, {"name": "insertion", "physical_tag": 4},
                {"name": "whole", "physical_tag": 3}, {"name": "tendon", "physical_tag": 2}],
    "region_materials": [{"region": "tendon", "material": {"neo_hookean": {"young_modulus": 1e6}}}],
    "constraints": [{"region": "origin"}], "loads": [{"region": "insertion", "traction": {"vector": [0, 0, 100]}}]}],
    "duration": 1, "output": {"frame_interval": 1}, "tet": {"stepping": "quasi_static"}})");
  const Finished run = Fascicle({"run", scene, "--json", "--out", folder_ / "out"});
  EXPECT_EQ(run.exit_code, 0) << run.err << run.out;

  // Its own format again.
  const Finished again = Fascicle({"mesh", folder_ / "bar.msh", "--convert", "--out", folder_ / "again.msh"});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(ReadFile(folder_ / "again.msh"), ReadFile(folder_ / "bar.msh"));
}

TEST_F(MeshTest, ConversionsThatFailSayWhy) {
  const auto refusal = [&](const std::string& name, const std::string& text, std::vector<std::string> more = {}) {
    std::vector<std::string> command = {"mesh", File(name, text), "--convert", "--out", folder_ / "x.msh"};
    command.insert(command.end(), more.begin(), more.end());
    const Finished finished = Fascicle(command);
    EXPECT_EQ(finished.exit_code, 2) << name;
    return finished.err;
  };
  EXPECT_THAT(refusal("a.e", "nothing"), HasSubstr("the file can't be read"));
  EXPECT_THAT(refusal("a.xdmf", "<Xdmf/>"), HasSubstr("write it as .vtu"));
  EXPECT_THAT(refusal("a.feb", "<febio_spec version=\"2.0\"/>"), HasSubstr("no mesh of FEBio 2.5, 3 or 4"));
  EXPECT_THAT(refusal("a.node", "1 3 0 0\n1 0 0 0\n"), HasSubstr("a.ele: there is no such file"));
  EXPECT_THAT(refusal("bar.obj", kBar), HasSubstr("is not that of a mesh"));
  EXPECT_THAT(refusal("b.inp", kAbaqus, {"--split-hexahedra", "--unit", "m"}),
              HasSubstr("give another one with --unit"));
  EXPECT_THAT(refusal("b.inp", kAbaqus, {"--size", "3"}), HasSubstr("--size"));
  EXPECT_FALSE(HasFile("x.msh"));
  // The other way round.
  const Finished finished = Fascicle({"mesh", File("c.inp", kAbaqus), "--out", folder_ / "x.msh"});
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.err, HasSubstr("--convert"));
}

TEST_F(MeshTest, SaysWhatWasRepairedOfASurface) {
  // A cube in the bar, with the same orientation; a corner of one of its triangles is off by 1e-6.
  std::string hollow = kBar;
  const char* const corners[] = {"8 8 28", "12 8 28", "12 12 28", "8 12 28",
                                 "8 8 32", "12 8 32", "12 12 32", "8 12 32"};
  for (const char* corner : corners) hollow += std::string("v ") + corner + "\n";
  hollow +=
      "v 12.000001 12 32\nf 9 12 11 10\nf 13 14 17 16\nf 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\nf 12 9 13 16\n";
  const Finished made = Fascicle({"mesh", File("hollow.obj", hollow), "--out", folder_ / "h.msh", "--size", "2"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, AllOf(HasSubstr("welded 1 corners with others within 6.63e-05 mm"),
                              HasSubstr("a surface lies inside of another at (10, 10, 30), 6.93 across"),
                              HasSubstr("volume              2393")));
}

TEST_F(MeshTest, ABrokenImageIsRefused) {
  const Finished refused =
      Fascicle({"mesh", File("broken.mha", "nothing"), "--label", "3", "--out", folder_ / "broken.msh"});
  EXPECT_EQ(refused.exit_code, 2) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("the file has no header of a MetaImage image"));
  EXPECT_FALSE(HasFile("broken.msh"));
}

}  // namespace
}  // namespace fascicle::testing
