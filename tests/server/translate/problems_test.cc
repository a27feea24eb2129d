// Wrong scenes: every problem is reported with its path and a hint, regardless of others.
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes.h"

namespace fascicle::server {
namespace {

using ::testing::HasSubstr;

// The problems of the box scene after merging `text` into its body.
Problems WithBody(const std::string& text, const Files& files = {}) {
  v1::Scene scene = BoxScene();
  EXPECT_TRUE(google::protobuf::TextFormat::MergeFromString(text, scene.mutable_bodies(0))) << text;
  return ProblemsOf(scene, files);
}

Problems WithScene(const std::string& text) {
  v1::Scene scene = BoxScene();
  EXPECT_TRUE(google::protobuf::TextFormat::MergeFromString(text, &scene)) << text;
  return ProblemsOf(scene);
}

TEST(Problems, AnEmptySceneSaysWhatItNeeds) {
  const Problems problems = ProblemsOf({});
  EXPECT_THAT(At(problems, "bodies"), HasSubstr("at least one body"));
  EXPECT_THAT(At(problems, "duration"), HasSubstr("missing"));
  EXPECT_THAT(At(problems, "output"), HasSubstr("frame_interval"));
  EXPECT_THAT(At(problems, "method"), HasSubstr("tet"));
}

TEST(Problems, AnEmptyBodySaysWhatItNeeds) {
  const Problems problems = WithScene("bodies {}");
  EXPECT_THAT(At(problems, "bodies[1].name"), HasSubstr("missing"));
  EXPECT_THAT(At(problems, "bodies[1].mesh"), HasSubstr("one of: file, box"));
  EXPECT_THAT(At(problems, "bodies[1].material"), HasSubstr("linear_elastic"));
  EXPECT_EQ(problems.count(), 3u) << problems.ToString();
}

TEST(Problems, Names) {
  EXPECT_THAT(At(WithScene("bodies { name: 'box' }"), "bodies[1].name"), HasSubstr("name of another body"));
  for (const char* name : {"a b", "..", ".", "a/b", "\xc3\xa4"}) {
    v1::Scene scene = BoxScene();
    scene.mutable_bodies(0)->set_name(name);
    EXPECT_THAT(At(ProblemsOf(scene), "bodies[0].name"), HasSubstr("not a name")) << name;
  }
  v1::Scene scene = BoxScene();
  scene.mutable_bodies(0)->set_name(std::string(65, 'a'));
  EXPECT_THAT(At(ProblemsOf(scene), "bodies[0].name"), HasSubstr("1 to 64 characters"));
  scene.mutable_bodies(0)->set_name(std::string(64, 'a'));
  EXPECT_TRUE(ProblemsOf(scene).empty());
  scene.set_name(std::string(201, 'x'));
  EXPECT_THAT(At(ProblemsOf(scene), "name"), HasSubstr("201 characters"));
  EXPECT_THAT(
      At(WithBody("regions { name: 'top' plane { point: [0,0,0] normal: [0,0,1] } }"), "bodies[0].regions[2].name"),
      HasSubstr("another region"));
}

TEST(Problems, ReferencesHintAtTheNearestName) {
  EXPECT_THAT(At(WithBody("constraints { region: 'botom' }"), "bodies[0].constraints[1].region"),
              HasSubstr("did you mean 'bottom'?"));
  EXPECT_THAT(At(WithBody("loads { nodal_force { total: [0,0,1] } }"), "bodies[0].loads[0].region"),
              HasSubstr("missing"));
  EXPECT_THAT(
      At(WithBody("fibres { harmonic { origin: 'tpo' insertion: 'bottom' } }"), "bodies[0].fibres.harmonic.origin"),
      HasSubstr("'top'"));
  EXPECT_THAT(At(WithScene("output { probes { name: 'p' body: 'bax' point: [0,0,0] } }"), "output.probes[0].body"),
              HasSubstr("did you mean 'box'?"));
}

// Hints take long to find: those of problems that are counted only are left out.
TEST(Problems, ThousandsOfWrongReferencesAreCounted) {
  v1::Scene scene = BoxScene();
  constexpr int kMany = 20'000;
  for (int i = 0; i < kMany; ++i) {
    v1::Region& region = *scene.mutable_bodies(0)->add_regions();
    region = scene.bodies(0).regions(0);
    region.set_name("region_with_a_long_name_" + std::to_string(i));
    scene.mutable_bodies(0)->add_constraints()->set_region("region_with_a_wrong_name_" + std::to_string(i));
  }
  const Problems problems = ProblemsOf(scene);
  EXPECT_GE(problems.count(), static_cast<std::size_t>(kMany));
  EXPECT_THAT(At(problems, "bodies[0].constraints[1].region"), HasSubstr("did you mean"));
}

TEST(Problems, ShapesThatContradictThemselves) {
  const auto with_mesh = [](const std::string& mesh) {
    v1::Scene scene = BoxScene();
    scene.mutable_bodies(0)->clear_mesh();
    EXPECT_TRUE(google::protobuf::TextFormat::MergeFromString(mesh, scene.mutable_bodies(0)->mutable_mesh())) << mesh;
    return ProblemsOf(scene);
  };
  EXPECT_THAT(At(with_mesh("torus { major_radius: 1 minor_radius: 1 }"), "bodies[0].mesh.torus.minor_radius"),
              HasSubstr("not less than the major radius"));
  EXPECT_THAT(At(with_mesh("torus { major_radius: 5 minor_radius: 1 divisions_across: 3 }"),
                 "bodies[0].mesh.torus.divisions_across"),
              HasSubstr("even"));
  EXPECT_THAT(At(with_mesh("sphere { radius: 1 divisions: 7 }"), "bodies[0].mesh.sphere.divisions"), HasSubstr("even"));
  EXPECT_THAT(
      At(with_mesh("fusiform { length: 9 belly_radius: 1 end_radius: 2 }"), "bodies[0].mesh.fusiform.end_radius"),
      HasSubstr("widest in the middle"));
  EXPECT_THAT(At(with_mesh("box { size: [1,1,1] divisions: [1000,1000,1000] }"), "bodies[0].mesh.box"),
              HasSubstr("6000000000 tetrahedra are too many"));
  EXPECT_THAT(At(with_mesh("box { size: [1,1,1] } elements { path: 'a.ele' }"), "bodies[0].mesh.elements"),
              HasSubstr("omit it"));
  EXPECT_THAT(At(with_mesh(""), "bodies[0].mesh.source"), HasSubstr("box"));
  EXPECT_THAT(At(with_mesh("box { size: [1e5,1e5,1e5] }"), "bodies[0].mesh.box"), HasSubstr("unit"));
}

TEST(Problems, TheLimitHoldsForAllBodiesTogether) {
  v1::Scene scene = BoxScene();
  *scene.add_bodies() = scene.bodies(0);
  scene.mutable_bodies(1)->set_name("second");
  TranslateLimits limits;
  limits.max_elements = 2 * 144 - 1;
  EXPECT_THAT(At(ProblemsOf(scene, {}, limits), "bodies[1].mesh.box"), HasSubstr("143 are left"));
  limits = {};
  limits.max_frame_bytes = 2 * 60 * 24 - 1;
  EXPECT_THAT(At(ProblemsOf(scene, {}, limits), "output.fields"), HasSubstr("2880 bytes"));
}

TEST(Problems, Regions) {
  const auto region = [](const std::string& selector) { return WithBody("regions { name: 'r' " + selector + " }"); };
  EXPECT_THAT(At(region(""), "bodies[0].regions[2].selector"), HasSubstr("missing"));
  EXPECT_THAT(At(region("plane { point: [0,0,5] normal: [0,0,1] }"), "bodies[0].regions[2].plane"),
              HasSubstr("from [0, 0, 0] to [2, 3, 4]"));
  EXPECT_THAT(At(region("plane { point: [0,0,0] normal: [0,0,0] }"), "bodies[0].regions[2].plane.normal"),
              HasSubstr("zero vector"));
  EXPECT_THAT(At(region("box { min: [0,0,2] max: [9,9,1] }"), "bodies[0].regions[2].box.min[2]"), HasSubstr("above"));
  EXPECT_THAT(At(region("sphere { center: [0,0,-9] radius: 1 }"), "bodies[0].regions[2].sphere"), HasSubstr("no node"));
  EXPECT_THAT(At(region("side { direction: [0,0,1] max_angle: 4 }"), "bodies[0].regions[2].side.max_angle"),
              HasSubstr("(0, 3.2]"));
  EXPECT_THAT(At(region("physical_tag: 3"), "bodies[0].regions[2].physical_tag"), HasSubstr("no tags"));
}

TEST(Problems, TagsThatAreThereAreListed) {
  Files files;
  const Problems problems = WithBody("unit: LENGTH_UNIT_MM mesh { file { path: 'a.msh' asset: '" + files.Add(kTwoTets) +
                                         "' } } regions { name: 'r' physical_tag: 3 }",
                                     files);
  EXPECT_THAT(At(problems, "bodies[0].regions[2].physical_tag"), HasSubstr("tags in the mesh file: 1, 7"));
}

TEST(Problems, Files) {
  Files files;
  const std::string asset = files.Add(kTwoTets);
  EXPECT_THAT(At(WithBody("mesh { file { path: 'a.msh' } }"), "bodies[0].mesh.file.asset"), HasSubstr("missing"));
  EXPECT_THAT(At(WithBody("mesh { file { asset: '" + asset + "' } }", files), "bodies[0].mesh.file.path"),
              HasSubstr("missing"));
  EXPECT_THAT(At(WithBody("mesh { file { path: 'a.msh' asset: 'assets/abc' } }"), "bodies[0].mesh.file.asset"),
              HasSubstr("64 lower-case"));
  EXPECT_THAT(At(WithBody("mesh { file { path: 'a.msh' asset: '" + asset + "' } }"), "bodies[0].mesh.file"),
              HasSubstr("not on the server"));
  EXPECT_THAT(At(WithBody("mesh { file { path: 'a.xyz' asset: '" + asset + "' } }", files), "bodies[0].mesh.file"),
              HasSubstr(".msh, .vtu"));
  EXPECT_THAT(At(WithBody("mesh { file { path: 'a.node' asset: '" + asset + "' } }", files), "bodies[0].mesh.elements"),
              HasSubstr("a.node"));
  EXPECT_THAT(At(WithBody("fibres { file { path: 'f.txt' asset: '" + files.Add("1 0 0\n") + "' } }", files),
                 "bodies[0].fibres.file"),
              HasSubstr("144"));
}

TEST(Problems, AMeshFileNeedsItsUnit) {
  Files files;
  v1::Scene scene = BoxScene();
  scene.mutable_bodies(0)->clear_unit();
  scene.mutable_bodies(0)->mutable_mesh()->mutable_file()->set_path("a.msh");
  std::string large = kTwoTets;
  for (std::size_t at = 0; (at = large.find("10", at)) != std::string::npos; at += 4) large.replace(at, 2, "1000");
  scene.mutable_bodies(0)->mutable_mesh()->mutable_file()->set_asset(files.Add(large));
  const Problems problems = ProblemsOf(scene, files);
  EXPECT_THAT(At(problems, "bodies[0].unit"), HasSubstr("missing"));
  EXPECT_THAT(At(problems, "bodies[0].mesh.file"), HasSubstr("mm"));
}

TEST(Problems, Fibres) {
  EXPECT_THAT(At(WithBody("material { muscle {} }"), "bodies[0].fibres"), HasSubstr("`muscle` needs"));
  EXPECT_THAT(At(WithBody("fibres {}"), "bodies[0].fibres.source"), HasSubstr("harmonic"));
  EXPECT_THAT(At(WithBody("fibres { constant { direction: [0,0,0] } }"), "bodies[0].fibres.constant.direction"),
              HasSubstr("zero vector"));
  EXPECT_THAT(
      At(WithBody("fibres { harmonic { origin: 'top' insertion: 'top' } }"), "bodies[0].fibres.harmonic.insertion"),
      HasSubstr("two different regions"));
  EXPECT_THAT(At(WithBody("regions { name: 'all' side { direction: [0,0,1] max_angle: 3.2 } } "
                          "fibres { harmonic { origin: 'all' insertion: 'top' } }"),
                 "bodies[0].fibres.harmonic"),
              HasSubstr("origin and to their insertion"));
}

TEST(Problems, Curves) {
  EXPECT_THAT(At(WithBody("activation { times: [0,1] values: [0,1.5] }"), "bodies[0].activation.values[1]"),
              HasSubstr("[0, 1]"));
  EXPECT_THAT(At(WithBody("activation { times: [0,1,1] values: [0,1,1] }"), "bodies[0].activation.times[2]"),
              HasSubstr("increase strictly"));
  EXPECT_THAT(At(WithBody("activation { times: [0,1] values: 0 }"), "bodies[0].activation.values"),
              HasSubstr("1 values for 2 times"));
  EXPECT_THAT(At(WithBody("activation {}"), "bodies[0].activation.times"), HasSubstr("missing"));
  v1::Scene scene = BoxScene();
  for (int i = 0; i < 10'001; ++i) {
    scene.mutable_bodies(0)->mutable_activation()->add_times(i * 0.01);
    scene.mutable_bodies(0)->mutable_activation()->add_values(0);
  }
  EXPECT_THAT(At(ProblemsOf(scene), "bodies[0].activation.times"), HasSubstr("10,000"));
}

TEST(Problems, ConstraintsAndMotions) {
  const Problems problems = WithBody(R"(constraints { region: "top" axes: AXIS_X axes: AXIS_X axes: AXIS_UNSPECIFIED
    motion {
      translation { axis: AXIS_Y curve { times: 0 values: 0 } }
      translation { axis: AXIS_X curve { times: 0 values: 11 } }
      translation { axis: AXIS_X }
      rotation { axis: [0,0,0] }
    } })");
  const std::string path = "bodies[0].constraints[1].";
  EXPECT_THAT(At(problems, path + "axes[1]"), HasSubstr("twice"));
  EXPECT_THAT(At(problems, path + "axes[2]"), HasSubstr("x, y or z"));
  EXPECT_THAT(At(problems, path + "motion.translation[0].axis"), HasSubstr("not constrained"));
  EXPECT_THAT(At(problems, path + "motion.translation[1].curve.values[0]"), HasSubstr("[-10, 10]"));
  EXPECT_THAT(At(problems, path + "motion.translation[2].curve"), HasSubstr("missing"));
  EXPECT_THAT(At(problems, path + "motion.translation[2].axis"), HasSubstr("already"));
  EXPECT_THAT(At(problems, path + "motion.rotation.axis"), HasSubstr("zero vector"));
  EXPECT_THAT(At(problems, path + "motion.rotation.angle"), HasSubstr("missing"));
}

TEST(Problems, Output) {
  const Problems problems = WithScene(R"(duration: 1000 output { frame_interval: 1e-6
    fields: FIELD_VELOCITY fields: FIELD_VELOCITY fields: FIELD_UNSPECIFIED fields: FIELD_FIBRE_STRETCH
    fields: FIELD_PENNATION_ANGLE
    probes { name: "p" body: "box" point: [0, 0, 400] } probes { name: "p" body: "box" point: [0, 0, 4] }
    moments { body: "bax" region: "x" } moments { body: "box" region: "nowhere" axis: [0, 0, 0] } })");
  EXPECT_THAT(At(problems, "output.frame_interval"), HasSubstr("100,000"));
  EXPECT_THAT(At(problems, "output.fields[1]"), HasSubstr("twice"));
  EXPECT_THAT(At(problems, "output.fields[2]"), HasSubstr("missing"));
  EXPECT_THAT(At(problems, "output.fields[3]"), HasSubstr("no body has fibres"));
  EXPECT_THAT(At(problems, "output.probes[0].point"), HasSubstr("own unit"));
  EXPECT_THAT(At(problems, "output.probes[1].name"), HasSubstr("another probe"));
  EXPECT_THAT(At(problems, "output.moments[0].body"), HasSubstr("did you mean 'box'"));
  EXPECT_THAT(At(problems, "output.moments[1].region"), HasSubstr("no region 'nowhere'"));
  EXPECT_THAT(At(problems, "output.moments[1].axis"), HasSubstr("zero vector"));
}

TEST(Problems, ChecksOfTheCoreAreRunOnTheBodiesThatAreWhole) {
  v1::Scene scene = BoxScene();
  scene.mutable_bodies(0)->mutable_mesh()->mutable_box()->set_size(0, -1);
  v1::Body& second = *scene.add_bodies();
  second = BoxScene().bodies(0);
  second.set_name("second");
  second.set_density(-1);
  google::protobuf::TextFormat::MergeFromString(
      R"(constraints { region: "bottom" motion { translation { axis: AXIS_X curve { times: 0 values: 0.1 } } } })",
      &second);
  v1::Body& third = *scene.add_bodies();
  third = BoxScene().bodies(0);
  third.set_name("third");
  third.clear_constraints();
  google::protobuf::TextFormat::MergeFromString(R"(loads { region: "top" nodal_force { total: [0, 0, 1] } })", &third);
  const Problems problems = ProblemsOf(scene);
  EXPECT_THAT(At(problems, "bodies[0].mesh.box.size[0]"), HasSubstr("(0, inf)"));
  EXPECT_THAT(At(problems, "bodies[1].density"), HasSubstr("(0, 30000]"));
  EXPECT_THAT(At(problems, "bodies[1].constraints[1]"), HasSubstr("differently"));
  EXPECT_THAT(At(problems, "bodies[2].constraints"), HasSubstr("no support balances the loads"));
  EXPECT_EQ(problems.count(), 4u) << problems.ToString();
}

TEST(Problems, NothingIsSaidTwice) {
  v1::Scene scene = BoxScene();
  v1::Body& body = *scene.mutable_bodies(0);
  body.set_density(std::numeric_limits<double>::quiet_NaN());
  body.mutable_activation()->add_times(0);
  body.mutable_activation()->add_values(2);
  body.mutable_material()->mutable_muscle()->set_bulk_modulus(-1);
  scene.mutable_output()->set_frame_interval(0);
  scene.set_duration(-1);
  const Problems problems = ProblemsOf(scene);
  EXPECT_EQ(problems.count(), 6u) << problems.ToString();
  EXPECT_THAT(At(problems, "bodies[0].material.muscle.bulk_modulus"), HasSubstr("(0, 1e12]"));
}

}  // namespace
}  // namespace fascicle::server
