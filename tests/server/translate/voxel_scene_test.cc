// Scenes of the voxel method: boxes and images become voxels, and problems are reported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "scenes.h"

namespace fascicle::server {
namespace {

using ::testing::HasSubstr;

v1::Scene VoxelBoxScene() {
  return ParseText(R"(
    name: "box" duration: 1 voxel {} output { frame_interval: 0.1 }
    bodies {
      name: "box" unit: LENGTH_UNIT_CM
      mesh { box { origin: [1, 0, 0] size: [2, 3, 4] divisions: [2, 3, 4] } }
      material { linear_elastic { young_modulus: 1e4 } }
      regions { name: "bottom" plane { point: [0, 0, 0] normal: [0, 0, -1] } }
      constraints { region: "bottom" }
    })");
}

// A MetaImage of 4 x 3 x 2 voxels of 1 x 2 x 3 mm whose first voxel is centred at (10, 20, 30) mm: label 1 where i < 2,
// label 7 elsewhere, and nothing in the last row.
std::string LabelImage() {
  std::string bytes =
      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
      "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 10 20 30\nCenterOfRotation = 0 0 0\nElementSpacing = 1 2 3\n"
      "DimSize = 4 3 2\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
  for (int k = 0; k < 2; ++k) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 4; ++i) bytes += j == 2 ? '\0' : i < 2 ? '\1' : '\7';
    }
  }
  return bytes;
}

v1::Scene ImageScene(Files& files, const std::string& bytes = LabelImage(), const std::string& name = "scan.mha") {
  v1::Scene scene = ParseText(R"(
    name: "scan" duration: 1 voxel {} output { frame_interval: 0.1 }
    bodies {
      name: "muscle" unit: LENGTH_UNIT_MM
      mesh { image { labels { values: [1, 7] } } }
      material { linear_elastic { young_modulus: 1e4 } }
      regions { name: "left" plane { point: [9.6, 0, 0] normal: [-1, 0, 0] } }
      regions { name: "tendon" physical_tag: 2 }
      region_materials { region: "tendon" material { linear_elastic { young_modulus: 1e8 } } }
      constraints { region: "left" }
    })");
  v1::FileRef& file = *scene.mutable_bodies(0)->mutable_mesh()->mutable_image()->mutable_file();
  file.set_path(name);
  file.set_asset(files.Add(bytes));
  return scene;
}

Problems WithVoxelBody(const std::string& text) {
  v1::Scene scene = VoxelBoxScene();
  EXPECT_TRUE(google::protobuf::TextFormat::MergeFromString(text, scene.mutable_bodies(0))) << text;
  return ProblemsOf(scene);
}

Problems WithImage(const std::string& text) {
  Files files;
  v1::Scene scene = ImageScene(files);
  EXPECT_TRUE(
      google::protobuf::TextFormat::MergeFromString(text, scene.mutable_bodies(0)->mutable_mesh()->mutable_image()))
      << text;
  return ProblemsOf(scene, files);
}

TEST(VoxelScene, ABoxBecomesVoxels) {
  const auto scene = Translate(VoxelBoxScene());
  ASSERT_NE(scene, nullptr);
  EXPECT_EQ(scene->method, Method::kVoxel);
  EXPECT_EQ(scene->voxel.stepping, VoxelStepping::kStatic);
  EXPECT_EQ(scene->voxel.tolerance, 1e-8);
  EXPECT_FALSE(scene->voxel.mean_dilatation);
  const Body& body = scene->bodies[0];
  EXPECT_TRUE(std::holds_alternative<VoxelShape>(body.shape));
  EXPECT_EQ(body.voxel().mesh.bricks.size(), 24u);
  EXPECT_EQ(body.nodes().size(), 3u * 4u * 5u);
  EXPECT_LT((body.nodes().front() - Vec3(0.01, 0, 0)).norm(), 1e-15);
  EXPECT_LT((body.nodes().back() - Vec3(0.03, 0.03, 0.04)).norm(), 1e-15);
  EXPECT_EQ(body.regions[0].quads.size(), 6u);
}

TEST(VoxelScene, SettingsOfTheMethod) {
  v1::Scene wire = VoxelBoxScene();
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString(
      "voxel { stepping: VOXEL_STEPPING_DYNAMIC time_step: 1e-3 tolerance: 1e-6 dilatation: DILATATION_MEAN "
      "start_loaded: true }",
      &wire));
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  EXPECT_EQ(scene->voxel.stepping, VoxelStepping::kDynamic);
  EXPECT_EQ(scene->voxel.time_step, 1e-3);
  EXPECT_EQ(scene->voxel.tolerance, 1e-6);
  EXPECT_TRUE(scene->voxel.mean_dilatation);
  EXPECT_TRUE(scene->voxel.start_loaded);
}

TEST(VoxelScene, LabelsBecomeVoxelsInTheirPlace) {
  Files files;
  const auto scene = Translate(ImageScene(files), files);
  ASSERT_NE(scene, nullptr);
  const Body& body = scene->bodies[0];
  EXPECT_EQ(body.voxel().mesh.bricks.size(), 16u);
  EXPECT_LT((body.nodes().front() - Vec3(0.0095, 0.019, 0.0285)).norm(), 1e-12);
  EXPECT_LT((body.nodes().back() - Vec3(0.0135, 0.023, 0.0345)).norm(), 1e-12);
  EXPECT_EQ(std::count(body.voxel().mesh.labels.begin(), body.voxel().mesh.labels.end(), 2), 8);
  EXPECT_EQ(body.regions[0].nodes.size(), 9u);
  EXPECT_EQ(body.regions[1].elements.size(), 8u);
  EXPECT_EQ(std::count(body.voxel().materials.of.begin(), body.voxel().materials.of.end(), 1), 8);
  ASSERT_FALSE(body.notes.empty());
  EXPECT_THAT(body.notes[0], HasSubstr("16 voxels"));
  // Needs the files of the scene, so it is kept with the job.
  EXPECT_EQ(AssetsOf(ImageScene(files)).size(), 1u);
}

TEST(VoxelScene, ThePhantomIsSegmented) {
  v1::Scene wire = VoxelBoxScene();
  wire.mutable_bodies(0)->set_unit(v1::LENGTH_UNIT_MM);
  wire.mutable_bodies(0)->clear_mesh();
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString(
      R"(image { phantom {} filters { wavelet {} } classes {} seeds { point: [49, 60, 17.75] }
                 cleaning { opening: 1.5 keep: KEPT_PARTS_SEEDS } level: 3 })",
      wire.mutable_bodies(0)->mutable_mesh()));
  wire.mutable_bodies(0)->mutable_regions(0)->mutable_plane()->set_point(2, 8);
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  // The true body has 117,910 voxels of 0.5 mm: 230 of 4 mm by volume, plus half-full ones at the rim.
  EXPECT_NEAR(static_cast<double>(scene->bodies[0].voxel().mesh.bricks.size()), 251, 8);
  ASSERT_EQ(scene->bodies[0].notes.size(), 2u);
  EXPECT_THAT(scene->bodies[0].notes[1], HasSubstr("thresholds between classes"));
}

TEST(VoxelScene, WhatVoxelsCantBe) {
  EXPECT_THAT(At(WithVoxelBody("mesh { sphere { radius: 1 } }"), "bodies[0].mesh"), HasSubstr("image or a box"));
  EXPECT_THAT(At(WithVoxelBody("material { neo_hookean { young_modulus: 1e4 } }"), "bodies[0].material"),
              HasSubstr("corotated_linear"));
  EXPECT_THAT(At(WithVoxelBody("fibres { constant { direction: [1, 0, 0] } }"), "bodies[0].fibres"),
              HasSubstr("no fibres"));
  EXPECT_THAT(At(WithVoxelBody("activation { times: 0 values: 0.5 }"), "bodies[0].activation"),
              HasSubstr("don't contract"));
  EXPECT_THAT(At(WithVoxelBody("damping { viscosity: 1 }"), "bodies[0].damping"), HasSubstr("mass"));
  v1::Scene floored = VoxelBoxScene();
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString(
      "floors { name: 'ground' point: [0, 0, -1] normal: [0, 0, 1] } output { settle_speed: 1 }", &floored));
  const Problems problems = ProblemsOf(floored);
  EXPECT_THAT(At(problems, "floors"), HasSubstr("tet method"));
  EXPECT_THAT(At(problems, "output.settle_speed"), HasSubstr("no speed"));
  v1::Scene with_fibres = VoxelBoxScene();
  with_fibres.mutable_output()->add_fields(v1::FIELD_FIBRE_STRETCH);
  EXPECT_THAT(At(ProblemsOf(with_fibres), "output.fields[0]"),
              HasSubstr("the voxel method does not provide fibre_stretch"));
  v1::Scene dynamic = VoxelBoxScene();
  dynamic.mutable_voxel()->set_stepping(v1::VOXEL_STEPPING_DYNAMIC);
  dynamic.set_duration(0.95);
  EXPECT_THAT(At(ProblemsOf(dynamic), "duration"), HasSubstr("multiple of"));
  v1::Scene loose = VoxelBoxScene();
  loose.mutable_bodies(0)->mutable_constraints(0)->add_axes(v1::AXIS_Z);
  EXPECT_THAT(At(ProblemsOf(loose), "bodies[0].constraints"), HasSubstr("along x"));
}

TEST(VoxelScene, TheTetMethodTakesNoImage) {
  Files files;
  v1::Scene scene = ImageScene(files);
  scene.mutable_tet();
  EXPECT_THAT(At(ProblemsOf(scene, files), "bodies[0].mesh.image"), HasSubstr("fascicle mesh"));
}

TEST(VoxelScene, TooManyVoxelsAreRefusedBeforeTheyAreMade) {
  v1::Scene scene = VoxelBoxScene();
  auto& divisions = *scene.mutable_bodies(0)->mutable_mesh()->mutable_box()->mutable_divisions();
  for (int d = 0; d < 3; ++d) divisions.Set(d, 1000);
  EXPECT_THAT(At(ProblemsOf(scene), "bodies[0].mesh.box"), HasSubstr("1000000000 voxels are too many"));
}

TEST(VoxelScene, WrongStagesAreNamed) {
  EXPECT_THAT(
      At(WithImage("filters { gaussian { deviation: -1 } }"), "bodies[0].mesh.image.filters[0].gaussian.deviation"),
      HasSubstr("outside the range"));
  EXPECT_THAT(At(WithImage("labels { values: 9 }"), "bodies[0].mesh.image.labels.values[2]"), HasSubstr("7"));
  EXPECT_THAT(At(WithImage("level: 11"), "bodies[0].mesh.image.level"), HasSubstr("outside the range"));
  EXPECT_THAT(At(WithImage("region { first: [0, 0, 0] size: [5, 1, 1] }"), "bodies[0].mesh.image.region"),
              HasSubstr("image"));
  EXPECT_THAT(
      At(WithImage("raw { size: [4, 3, 2] spacing: [1, 1, 1] type: 'int12' }"), "bodies[0].mesh.image.raw.type"),
      HasSubstr("int16"));
}

TEST(VoxelScene, WrongImagesAreNamed) {
  Files files;
  const std::string whole = LabelImage();
  EXPECT_FALSE(ProblemsOf(ImageScene(files, whole.substr(0, whole.size() - 5)), files).empty());
  EXPECT_THAT(At(ProblemsOf(ImageScene(files, whole.substr(0, whole.size() - 5)), files), "bodies[0].mesh.image.file"),
              HasSubstr("byte"));
  std::string huge = whole;
  huge.replace(huge.find("DimSize = 4 3 2"), 15, "DimSize = 10000 10000 10000");
  EXPECT_FALSE(At(ProblemsOf(ImageScene(files, huge), files), "bodies[0].mesh.image.file").starts_with("nothing"));
  EXPECT_FALSE(At(ProblemsOf(ImageScene(files, ""), files), "bodies[0].mesh.image.file").starts_with("nothing"));
  EXPECT_FALSE(
      At(ProblemsOf(ImageScene(files, whole, "scan.nii"), files), "bodies[0].mesh.image.file").starts_with("nothing"));
  v1::Scene without = VoxelBoxScene();
  without.mutable_bodies(0)->mutable_mesh()->mutable_image();
  EXPECT_THAT(At(ProblemsOf(without), "bodies[0].mesh.image"), HasSubstr("file, phantom"));
}

TEST(VoxelScene, TheForceOfAMuscleIsAPull) {
  v1::Scene wire = VoxelBoxScene();
  ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString(
      R"(regions { name: "top" plane { point: [0, 0, 4] normal: [0, 0, 1] } }
         loads { region: "top" stern { origin_distance: 0.25 insertion_distance: 0.04 peak_force: 800 optimal_angle: 1.7
                 angle { times: 0 values: 1.7 } activation { times: [0, 1] values: [0, 1] } direction: [0, 0, -2] } })",
      wire.mutable_bodies(0)));
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  const Load& load = scene->bodies[0].loads[0];
  EXPECT_EQ(std::get<NodalForce>(load.kind).total, Vec3(0, 0, -1));
  ASSERT_TRUE(load.stern);
  EXPECT_EQ(load.stern->muscle.insertion_distance, 0.04);
  EXPECT_EQ(load.stern->muscle.peak_force, 800);
  EXPECT_EQ(load.stern->muscle.hill_curvature, 0.25);
  EXPECT_EQ(load.stern->drive.angle.At(0.5), 1.7);
  EXPECT_EQ(load.stern->drive.activation.At(0.5), 0.5);
  wire.mutable_bodies(0)->mutable_loads(0)->mutable_stern()->clear_angle();
  wire.mutable_bodies(0)->mutable_loads(0)->mutable_scale()->add_times(0);
  const Problems problems = ProblemsOf(wire);
  EXPECT_THAT(At(problems, "bodies[0].loads[0].stern.angle"), HasSubstr("missing"));
  EXPECT_THAT(At(problems, "bodies[0].loads[0].scale"), HasSubstr("activation"));
}

}  // namespace
}  // namespace fascicle::server
