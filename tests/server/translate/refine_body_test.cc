// `refinements` of a scene: what the parts of an element take from it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/shapes.h"
#include "scenes.h"

namespace fascicle::server {
namespace {

using ::testing::HasSubstr;

// A box with everything that elements and nodes can carry: 2 x 3 x 4 hexahedra, 144 tetrahedra, 60 nodes.
v1::Scene LadenScene(Files& files) {
  v1::Scene scene = BoxScene();
  v1::Body& body = *scene.mutable_bodies(0);
  google::protobuf::TextFormat::MergeFromString(R"(
    regions { name: "upper" plane { point: [0, 0, 2] normal: [0, 0, 1] } }
    region_materials { region: "upper" material { neo_hookean { young_modulus: 2e4 } } }
    region_activations { region: "upper" curve { times: 0 values: 0.75 } }
    activation_scale { path: "s.txt" } initial_displacement { path: "u.txt" }
    fibres { constant { direction: [0, 0, 1] } })",
                                                &body);
  std::string scale, displacement;
  for (int t = 0; t < 144; ++t) scale += std::to_string(t / 200.0) + "\n";
  for (int k = 0; k < 5; ++k) {
    for (int n = 0; n < 12; ++n) displacement += "0 0 " + std::to_string(0.01 * k) + "\n";
  }
  body.mutable_activation_scale()->set_asset(files.Add(scale));
  body.mutable_initial_displacement()->set_asset(files.Add(displacement));
  return scene;
}

TEST(RefineBody, PartsTakeWhatTheirElementHas) {
  Files files;
  v1::Scene wire = LadenScene(files);
  const auto coarse = Translate(wire, files);
  wire.set_refinements(2);
  const auto fine = Translate(wire, files);
  ASSERT_TRUE(coarse != nullptr && fine != nullptr);
  const TetShape &before = coarse->bodies[0].tet(), &after = fine->bodies[0].tet();
  ASSERT_EQ(after.mesh.tetrahedra.size(), 64 * 144u);
  EXPECT_NEAR(TotalVolume(after.mesh), TotalVolume(before.mesh), 1e-15);
  for (std::size_t t = 0; t < 64 * 144; ++t) {
    ASSERT_EQ(after.materials.of[t], before.materials.of[t / 64]);
    ASSERT_EQ(after.activations.of[t], before.activations.of[t / 64]);
    ASSERT_EQ(after.activation_scale[t], before.activation_scale[t / 64]);
    ASSERT_EQ(after.fibres[t], before.fibres[t / 64]);
  }
  // The displacement is linear in z: 0.01 cm for every layer of 1 cm.
  ASSERT_EQ(after.initial_displacement.size(), after.mesh.nodes.size());
  for (std::size_t n = 0; n < after.mesh.nodes.size(); ++n) {
    ASSERT_NEAR(after.initial_displacement[n].z(), 0.01 * after.mesh.nodes[n].z(), 1e-12);
  }
}

TEST(RefineBody, PartsOfHexahedraTakeWhatTheyHave) {
  Files files;
  v1::Scene wire = LadenScene(files);
  std::string scale;
  for (int h = 0; h < 24; ++h) scale += std::to_string(h / 200.0) + "\n";
  wire.mutable_bodies(0)->mutable_activation_scale()->set_asset(files.Add(scale));
  wire.mutable_tet()->set_element(v1::ELEMENT_HEXAHEDRAL);
  const auto coarse = Translate(wire, files);
  wire.set_refinements(2);
  const auto fine = Translate(wire, files);
  ASSERT_TRUE(coarse != nullptr && fine != nullptr);
  const TetShape &before = coarse->bodies[0].tet(), &after = fine->bodies[0].tet();
  ASSERT_EQ(after.mesh.hexahedra.size(), 64 * 24u);
  ASSERT_EQ(after.mesh.nodes.size(), 9 * 13 * 17u);
  EXPECT_NEAR(TotalVolume(after.mesh), TotalVolume(before.mesh), 1e-15);
  for (std::size_t h = 0; h < 64 * 24; ++h) {
    ASSERT_EQ(after.materials.of[h], before.materials.of[h / 64]);
    ASSERT_EQ(after.activations.of[h], before.activations.of[h / 64]);
    ASSERT_EQ(after.activation_scale[h], before.activation_scale[h / 64]);
    ASSERT_EQ(after.fibres[h], before.fibres[h / 64]);
  }
  ASSERT_EQ(after.initial_displacement.size(), after.mesh.nodes.size());
  for (std::size_t n = 0; n < after.mesh.nodes.size(); ++n) {
    ASSERT_NEAR(after.initial_displacement[n].z(), 0.01 * after.mesh.nodes[n].z(), 1e-12);
  }
  EXPECT_EQ(fine->bodies[0].regions[0].sides.size(), 8 * 12u);
}

TEST(RefineBody, RegionsCoverTheSamePart) {
  v1::Scene wire = BoxScene();
  wire.set_refinements(1);
  const auto fine = Translate(wire);
  ASSERT_NE(fine, nullptr);
  const Region& bottom = fine->bodies[0].regions[0];
  EXPECT_EQ(bottom.nodes.size(), 5 * 7u);
  EXPECT_EQ(bottom.triangles.size(), 2 * 4 * 6u);
  EXPECT_THAT(fine->bodies[0].notes.back(), HasSubstr("refined to 1152 elements"));
}

TEST(RefineBody, VoxelsAndGridsAreHalvedToo) {
  v1::Scene wire = BoxScene();
  wire.mutable_voxel();
  v1::Body& body = *wire.mutable_bodies(0);
  google::protobuf::TextFormat::MergeFromString(R"(
    regions { name: "upper" plane { point: [0, 0, 2] normal: [0, 0, 1] } }
    region_materials { region: "upper" material { linear_elastic { young_modulus: 2e4 } } })",
                                                &body);
  body.mutable_material()->mutable_linear_elastic()->set_young_modulus(1e4);
  wire.set_refinements(1);
  const auto voxels = Translate(wire);
  ASSERT_NE(voxels, nullptr);
  const VoxelShape& shape = voxels->bodies[0].voxel();
  ASSERT_EQ(shape.mesh.bricks.size(), 8 * 24u);
  EXPECT_EQ(voxels->bodies[0].regions[0].quads.size(), 4 * 6u);
  for (std::size_t b = 0; b < shape.mesh.bricks.size(); ++b) {
    const bool upper = shape.mesh.nodes[shape.mesh.bricks[b][0]].z() > 0.02 - 1e-9;
    ASSERT_EQ(shape.materials.of[b], upper ? 1 : 0);
  }

  v1::Scene grid = BoxScene();
  grid.mutable_eulerian()->set_cell_size(0.004);
  EXPECT_EQ(Translate(grid)->eulerian.cell_size, 0.004);
  grid.set_refinements(1);
  EXPECT_EQ(Translate(grid)->eulerian.cell_size, 0.002);
}

TEST(RefineBody, CountsItsParts) {
  v1::Scene wire = BoxScene();
  wire.set_refinements(3);
  EXPECT_THAT(At(ProblemsOf(wire, {}, {.max_elements = 70000}), "refinements"),
              HasSubstr("73728 elements of bodies[0] are too many; 70000 are left"));
  EXPECT_TRUE(ProblemsOf(wire, {}, {.max_elements = 80000}).empty());
  wire.set_refinements(4);
  EXPECT_THAT(At(ProblemsOf(wire), "refinements"), HasSubstr("[0, 3]"));
}

}  // namespace
}  // namespace fascicle::server
