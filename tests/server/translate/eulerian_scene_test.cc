// Scenes of the eulerian method: surfaces and boundaries of tetrahedra become solids on grids, and problems are
// reported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/eulerian/scene_body.h"
#include "scenes.h"

namespace fascicle::server {
namespace {

using ::testing::HasSubstr;

v1::Scene BlockScene() {
  return ParseText(R"(
    name: "block" duration: 1 eulerian { cell_size: 0.01 } output { frame_interval: 0.1 }
    bodies {
      name: "block" unit: LENGTH_UNIT_CM
      mesh { box { size: [8, 6, 6] divisions: [4, 3, 3] } }
      material { neo_hookean { young_modulus: 1e4 } }
      regions { name: "end" box { min: [0, 0, 0] max: [1, 6, 6] } }
      regions { name: "far" plane { point: [8, 0, 0] normal: [1, 0, 0] } }
      constraints { region: "end" }
    })");
}

// A cube of 60 mm as an OBJ file with outward triangles.
const std::vector<std::string> kFaces = {"1 3 2", "1 4 3", "5 6 7", "5 7 8", "1 2 6", "1 6 5",
                                         "2 3 7", "2 7 6", "3 4 8", "3 8 7", "4 1 5", "4 5 8"};
std::string Cube(const std::vector<std::string>& faces = kFaces) {
  std::string text = "v 0 0 0\nv 60 0 0\nv 60 60 0\nv 0 60 0\nv 0 0 60\nv 60 0 60\nv 60 60 60\nv 0 60 60\n";
  for (const std::string& face : faces) text += "f " + face + "\n";
  return text;
}

v1::Scene SurfaceScene(Files& files, const std::string& bytes = Cube(), const std::string& name = "cube.obj") {
  v1::Scene scene = ParseText(R"(
    name: "surface" duration: 1 eulerian { cell_size: 0.01 } output { frame_interval: 0.1 }
    bodies {
      name: "cube" unit: LENGTH_UNIT_MM
      material { neo_hookean { young_modulus: 1e4 } }
      regions { name: "low" plane { point: [0, 0, 0] normal: [0, 0, -1] } }
      constraints { region: "low" }
    })");
  v1::FileRef& file = *scene.mutable_bodies(0)->mutable_mesh()->mutable_surface();
  file.set_path(name);
  file.set_asset(files.Add(bytes));
  return scene;
}

Problems WithBlock(const std::string& text) {
  v1::Scene scene = BlockScene();
  EXPECT_TRUE(google::protobuf::TextFormat::MergeFromString(text, scene.mutable_bodies(0))) << text;
  return ProblemsOf(scene);
}

Problems EulerianProblems(const std::string& text) {
  v1::Scene scene = BlockScene();
  EXPECT_TRUE(google::protobuf::TextFormat::MergeFromString(text, &scene)) << text;
  return ProblemsOf(scene);
}

TEST(EulerianScene, ABoxBecomesItsSurface) {
  const auto scene = Translate(BlockScene());
  ASSERT_NE(scene, nullptr);
  EXPECT_EQ(scene->method, Method::kEulerian);
  const Body& body = scene->bodies[0];
  EXPECT_NEAR(EnclosedVolume(body.surface().mesh), 0.08 * 0.06 * 0.06, 1e-15);
  EXPECT_EQ(body.surface().mesh.triangles.size(), 2u * 2u * (4 * 3 + 4 * 3 + 3 * 3));
  // The number of nodes of a closed surface of genus 0; interior nodes are removed.
  EXPECT_EQ(body.nodes().size(), body.surface().mesh.triangles.size() / 2 + 2);
  EXPECT_EQ(body.regions[1].nodes.size(), 16u);
  EXPECT_EQ(body.regions[1].triangles.size(), 18u);
  EXPECT_EQ(body.regions[0].selectors.size(), 1u);
  const EulerianGrid grid = GridOf(scene->eulerian, body.surface().mesh);
  EXPECT_EQ(grid.spacing, 0.01);
  EXPECT_EQ(grid.cells, (GridIndex{16, 14, 14}));  // 8 x 6 x 6 cells and half of 8 on every side
  EXPECT_LT((grid.origin + Vec3::Constant(0.04)).norm(), 1e-12);
}

TEST(EulerianScene, SettingsOfTheMethod) {
  v1::Scene wire = BlockScene();
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString(
      R"(eulerian { lowest: [-0.1, -0.2, -0.3] highest: [0.2, 0.2, 0.2] volume: VOLUME_TREATMENT_DIVERGENCE_FREE
                    stabilization: 0.1 elastic_force: ELASTIC_FORCE_IMPLICIT time_step: 1e-3
                    advection: ADVECTION_MACCORMACK }
         squeezes { point: [0.04, 0, 0] normal: [2, 0, 0] force_density: 1e4 width: 0.01
                    scale { times: [0, 1] values: [1, 0] } }
         bodies { plasticity { yield_stress: 500 } })",
      &wire));
  // The merged text defines plasticity for the second body; moves it to the first.
  *wire.mutable_bodies(0)->mutable_plasticity() = wire.bodies(1).plasticity();
  wire.mutable_bodies()->RemoveLast();
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  const EulerianMethod& method = scene->eulerian;
  ASSERT_TRUE(method.room.has_value());
  EXPECT_EQ(method.room->lowest, Vec3(-0.1, -0.2, -0.3));
  EXPECT_EQ(method.volume, VolumeTreatment::kDivergenceFree);
  EXPECT_EQ(method.stabilization, 0.1);
  EXPECT_TRUE(method.implicit_elasticity);
  EXPECT_TRUE(method.maccormack);
  EXPECT_EQ(method.time_step, 1e-3);
  ASSERT_EQ(scene->squeezes.size(), 1u);
  EXPECT_EQ(scene->squeezes[0].normal, Vec3::UnitX());
  EXPECT_EQ(scene->squeezes[0].force_density, 1e4);
  EXPECT_EQ(scene->squeezes[0].scale.At(0.5), 0.5);
  ASSERT_TRUE(scene->bodies[0].surface().plasticity.has_value());
  EXPECT_EQ(scene->bodies[0].surface().plasticity->yield_stress, 500);
  EXPECT_EQ(scene->bodies[0].surface().plasticity->relaxation_time, 0);
}

TEST(EulerianScene, ASurfaceFileIsEnough) {
  Files files;
  v1::Scene wire = SurfaceScene(files);
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString(
      "material { muscle { bulk_modulus: 1e6 } } fibres { constant { direction: [0, 0, 3] } }",
      wire.mutable_bodies(0)));
  EXPECT_EQ(AssetsOf(wire).size(), 1u);
  const auto scene = Translate(wire, files);
  ASSERT_NE(scene, nullptr);
  const Body& body = scene->bodies[0];
  EXPECT_NEAR(EnclosedVolume(body.surface().mesh), std::pow(0.06, 3), 1e-15);
  EXPECT_TRUE(body.surface().filling.nodes.empty());
  EXPECT_EQ(body.regions[0].nodes.size(), 4u);
  ASSERT_EQ(body.surface().fibres.size(), 1u);
  EXPECT_EQ(body.surface().fibres[0], Vec3::UnitZ());
}

TEST(EulerianScene, ASupportMayBeInside) {
  Files files;
  v1::Scene wire = SurfaceScene(files);
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString(
      R"(regions { name: "core" sphere { center: [30, 30, 30] radius: 12 } } constraints { region: "core" })",
      wire.mutable_bodies(0)));
  const auto scene = Translate(wire, files);
  ASSERT_NE(scene, nullptr);
  ThreadTeam team(1);
  const EulerianBody body = MakeEulerianBody(*scene, scene->bodies[0], team);
  EXPECT_EQ(body.SupportOf(Vec3(0.03, 0.03, 0.03)), 1);
  EXPECT_EQ(body.SupportOf(Vec3(0.03, 0.03, 0.05)), -1);
  EXPECT_EQ(body.SupportOf(Vec3(0.03, 0.03, 0)), 0);
}

TEST(EulerianScene, FibresOfTetrahedraStay) {
  v1::Scene wire = BlockScene();
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString(
      R"(material { muscle { bulk_modulus: 1e6 } } fibres { harmonic { origin: "end" insertion: "far" } }
         activation { times: 0 values: 0.5 })",
      wire.mutable_bodies(0)));
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  const Body& body = scene->bodies[0];
  EXPECT_EQ(body.surface().fibres.size(), body.surface().filling.tetrahedra.size());
  const v1::Geometry geometry = EncodeGeometry(*scene, {});
  EXPECT_TRUE(geometry.bodies(0).tetrahedra().empty());
  EXPECT_TRUE(geometry.bodies(0).fibres().empty());
  EXPECT_EQ(geometry.bodies(0).triangles().size(), 12 * body.surface().mesh.triangles.size());
  EXPECT_EQ(geometry.bodies(0).positions().size(), 24 * body.surface().mesh.nodes.size());
}

TEST(EulerianScene, SurfacesThatBoundNoSolid) {
  Files files;
  std::vector<std::string> open = kFaces;
  open.pop_back();
  EXPECT_THAT(At(ProblemsOf(SurfaceScene(files, Cube(open)), files), "bodies[0].mesh.surface"),
              HasSubstr("3 edges of the surface lack a triangle"));
  std::vector<std::string> turned;
  for (const std::string& face : kFaces) turned.push_back({face[0], ' ', face[4], ' ', face[2]});
  EXPECT_THAT(At(ProblemsOf(SurfaceScene(files, Cube(turned)), files), "bodies[0].mesh.surface"),
              HasSubstr("is inverted"));
  v1::Scene coarse = SurfaceScene(files);
  coarse.mutable_eulerian()->set_cell_size(0.02);
  EXPECT_THAT(At(ProblemsOf(coarse, files), "bodies[0].mesh.surface"), HasSubstr("4 are needed"));
  EXPECT_THAT(At(ProblemsOf(SurfaceScene(files, "v 0 0"), files), "bodies[0].mesh.surface"), HasSubstr("line 1"));
  EXPECT_THAT(At(ProblemsOf(SurfaceScene(files, Cube(), "cube.msh"), files), "bodies[0].mesh.surface"),
              HasSubstr(".stl"));
}

TEST(EulerianScene, SurfaceFilesNeedAUnitAndUniformFibres) {
  Files files;
  v1::Scene scene = SurfaceScene(files);
  scene.mutable_bodies(0)->clear_unit();
  EXPECT_THAT(At(ProblemsOf(scene, files), "bodies[0].unit"), HasSubstr("does not say its unit"));
  EXPECT_EQ(ProblemsOf(scene, files).count(), 1u);
  v1::Scene fibres = SurfaceScene(files);
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString(R"(fibres { harmonic { origin: "low" insertion: "low" } })",
                                                            fibres.mutable_bodies(0)));
  EXPECT_THAT(At(ProblemsOf(fibres, files), "bodies[0].fibres"), HasSubstr("constant"));
  v1::Scene pennate = SurfaceScene(files);
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString(
      "fibres { constant { direction: [1, 0, 0] } pennation { angle: 0.3 normal: [0, 1, 0] } }",
      pennate.mutable_bodies(0)));
  EXPECT_THAT(At(ProblemsOf(pennate, files), "bodies[0].fibres.pennation"), HasSubstr("without pennation"));
}

TEST(EulerianScene, OtherMethodsTakeNoSurfaces) {
  Files files;
  v1::Scene tet = SurfaceScene(files), voxel = SurfaceScene(files);
  tet.mutable_tet();
  voxel.mutable_voxel();
  EXPECT_THAT(At(ProblemsOf(tet, files), "bodies[0].mesh.surface"), HasSubstr("fascicle mesh"));
  EXPECT_THAT(At(ProblemsOf(voxel, files), "bodies[0].mesh"), HasSubstr("image or a box"));
}

TEST(EulerianScene, WhatOtherMethodsDoNotKnow) {
  v1::Scene scene = BlockScene();
  scene.mutable_tet();
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString("squeezes { normal: [1, 0, 0] force_density: 1 }", &scene));
  scene.mutable_bodies(0)->mutable_plasticity()->set_yield_stress(1);
  const Problems problems = ProblemsOf(scene);
  EXPECT_THAT(At(problems, "squeezes"), HasSubstr("eulerian method"));
  EXPECT_THAT(At(problems, "bodies[0].plasticity"), HasSubstr("eulerian method"));
}

TEST(EulerianScene, WhatTheMethodDoesNotKnow) {
  const Problems problems = WithBlock(R"(
      region_materials { region: "end" material { neo_hookean { young_modulus: 1e5 } } }
      damping { viscosity: 1 } constraints { region: "far" axes: AXIS_X })");
  EXPECT_THAT(At(problems, "bodies[0].region_materials"), HasSubstr("no elements"));
  EXPECT_THAT(At(problems, "bodies[0].damping"), HasSubstr("mass_proportional"));
  EXPECT_THAT(At(problems, "bodies[0].constraints[1].axes"), HasSubstr("all three"));
  EXPECT_THAT(At(WithBlock(R"(fibres { constant { direction: [1, 0, 0] } }
                              material { muscle { max_velocity: 5 } })"),
                 "bodies[0].material"),
              HasSubstr("max_velocity"));
  EXPECT_THAT(At(WithBlock(R"(fibres { constant { direction: [1, 0, 0] } } material { muscle {} }
                              region_activations { region: "end" curve { times: 0 values: 1 } })"),
                 "bodies[0].region_activations"),
              HasSubstr("no elements"));
}

// A second block, 9 cm or less from the first one, and what `contacts` say.
Problems WithSecondBlock(double at, const std::string& contacts) {
  v1::Scene scene = BlockScene();
  v1::Body& second = *scene.add_bodies();
  second = scene.bodies(0);
  second.set_name("second");
  second.clear_regions();  // those are at the first block
  second.clear_constraints();
  second.clear_loads();
  for (const double x : {at, 0.0, 0.0}) second.mutable_mesh()->mutable_box()->add_origin(x);
  EXPECT_TRUE(google::protobuf::TextFormat::MergeFromString(contacts, &scene)) << contacts;
  return ProblemsOf(scene);
}

TEST(EulerianScene, ContactsNameBodiesThatDoNotOverlap) {
  EXPECT_TRUE(WithSecondBlock(9, "contacts {}").empty());
  EXPECT_TRUE(WithSecondBlock(9, "contacts { bodies: ['block', 'second'] }").empty());
  EXPECT_TRUE(WithSecondBlock(7.8, "contacts {}").empty());  // 0.2 cells deep
  EXPECT_TRUE(WithSecondBlock(5, "").empty());
  EXPECT_THAT(At(WithSecondBlock(5, "contacts {}"), "bodies[1]"),
              HasSubstr("overlaps with the body `block` by 0.0289 m"));
  EXPECT_THAT(At(WithSecondBlock(9, "contacts { bodies: ['block', 'secnd'] }"), "contacts[0].bodies[1]"),
              HasSubstr("secnd"));
  EXPECT_THAT(At(WithSecondBlock(9, "contacts { bodies: ['block', 'block'] }"), "contacts[0].bodies[1]"),
              HasSubstr("more than once"));
  EXPECT_THAT(At(WithSecondBlock(9, "contacts { bodies: 'block' }"), "contacts[0].bodies"), HasSubstr("two bodies"));
  EXPECT_THAT(At(WithSecondBlock(9, "contacts { friction: 0.1 }"), "contacts[0].friction"), HasSubstr("yet"));
  EXPECT_THAT(At(WithSecondBlock(9, "contacts { lasting: true }"), "contacts[0].lasting"), HasSubstr("yet"));
  EXPECT_THAT(At(WithSecondBlock(9, "contacts { friction: -1 }"), "contacts[0].friction"), HasSubstr("[0, 10]"));
}

TEST(EulerianScene, TagsTellNoPointsOfTheMaterial) {
  Files files;
  v1::Scene scene = BlockScene();
  v1::Body& body = *scene.mutable_bodies(0);
  body.mutable_mesh()->mutable_file()->set_path("two.msh");
  body.mutable_mesh()->mutable_file()->set_asset(files.Add(kTwoTets));
  body.mutable_regions(0)->set_physical_tag(1);
  body.mutable_regions(1)->mutable_plane()->set_point(0, 10);
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString(
      R"(loads { region: "end" nodal_force { total: [1, 0, 0] } })", &body));
  const Problems problems = ProblemsOf(scene, files);
  EXPECT_THAT(At(problems, "bodies[0].constraints[0].region"), HasSubstr("plane, box, sphere or side"));
  EXPECT_THAT(At(problems, "bodies[0].loads[0].region"), HasSubstr("plane, box, sphere or side"));
}

TEST(EulerianScene, GridsThatCannotBe) {
  EXPECT_THAT(At(EulerianProblems("eulerian { cell_size: 1e-6 }"), "eulerian.cell_size"),
              HasSubstr("cells are too many"));
  EXPECT_THAT(At(EulerianProblems("eulerian { cell_size: 1e-300 }"), "eulerian.cell_size"),
              HasSubstr("cells are too many"));
  EXPECT_THAT(At(EulerianProblems("eulerian { cell_size: 0 }"), "eulerian.cell_size"), HasSubstr("missing or 0"));
  EXPECT_THAT(At(EulerianProblems("eulerian { lowest: [0.1, 0, 0] highest: [0, 1, 1] }"), "eulerian.lowest[0]"),
              HasSubstr("swap lowest and highest"));
  EXPECT_THAT(At(EulerianProblems("eulerian { lowest: [0.1, 0, 0] }"), "eulerian.highest"), HasSubstr("both"));
  EXPECT_THAT(At(EulerianProblems("eulerian { lowest: [-1, -1, -1] highest: [0.1, 0.05, 0.1] }"), "bodies[0].mesh"),
              HasSubstr("eulerian.lowest"));
  v1::Scene missing = BlockScene();
  missing.mutable_eulerian()->clear_cell_size();
  EXPECT_THAT(At(ProblemsOf(missing), "eulerian.cell_size"), HasSubstr("missing"));
  const v1::Scene wide = BlockScene();
  TranslateLimits limits;
  limits.max_elements = 16 * 14 * 14;
  EXPECT_TRUE(ProblemsOf(wide, {}, limits).empty());
  --limits.max_elements;
  EXPECT_THAT(At(ProblemsOf(wide, {}, limits), "eulerian.cell_size"), HasSubstr("3136 cells are too many"));
}

TEST(EulerianScene, WrongNumbersAreNamed) {
  const Problems problems = EulerianProblems(R"(
      squeezes { normal: [0, 0, 0] force_density: 1 } squeezes { normal: [1, 0, 0] force_density: -1 }
      squeezes { normal: [1, 0, 0] force_density: 1 scale { times: 0 values: 1e9 } }
      eulerian { stabilization: -1 margin: 0 })");
  EXPECT_THAT(At(problems, "squeezes[0].normal"), HasSubstr("zero"));
  EXPECT_THAT(At(problems, "squeezes[1].force_density"), HasSubstr("outside the range"));
  EXPECT_THAT(At(problems, "squeezes[2].scale.values[0]"), HasSubstr("1000"));
  EXPECT_THAT(At(problems, "eulerian.stabilization"), HasSubstr("outside the range"));
  EXPECT_THAT(At(problems, "eulerian.margin"), HasSubstr("outside the range"));
  EXPECT_THAT(At(WithBlock("plasticity { yield_stress: -1 }"), "bodies[0].plasticity.yield_stress"),
              HasSubstr("outside the range"));
}

TEST(EulerianScene, WhatNothingHoldsWouldFlyAway) {
  v1::Scene scene = BlockScene();
  scene.mutable_bodies(0)->clear_constraints();
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString("gravity { acceleration: [0, 0, -9.81] }", &scene));
  EXPECT_THAT(At(ProblemsOf(scene), "bodies[0].constraints"), HasSubstr("along z"));
}

}  // namespace
}  // namespace fascicle::server
