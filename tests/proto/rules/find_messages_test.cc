#include "proto/rules/find_messages.h"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include "fascicle/v1/scene.pb.h"
#include "proto/rules/enum_names.h"

namespace fascicle {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

v1::Scene SceneWithFiles() {
  v1::Scene scene;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
      R"(bodies { mesh { image { file { path: "a" } more_files { path: "b" } more_files { path: "c" } } } }
         bodies { mesh { file { path: "d" } } fibres { bspline { file { path: "e" } } } activation_scale { path: "f" } })",
      &scene));
  return scene;
}

TEST(ForEachMessageTest, FindsThemAtAnyDepthWithTheirPaths) {
  const v1::Scene scene = SceneWithFiles();
  std::vector<std::pair<std::string, std::string>> found;
  ForEachMessage<v1::FileRef>(
      scene, "", [&](const v1::FileRef& file, const std::string& path) { found.emplace_back(path, file.path()); });
  EXPECT_THAT(found,
              ElementsAre(Pair("bodies[0].mesh.image.file", "a"), Pair("bodies[0].mesh.image.more_files[0]", "b"),
                          Pair("bodies[0].mesh.image.more_files[1]", "c"), Pair("bodies[1].mesh.file", "d"),
                          Pair("bodies[1].fibres.bspline.file", "e"), Pair("bodies[1].activation_scale", "f")));
}

TEST(ForEachMessageTest, WhatIsFoundCanBeChanged) {
  v1::Scene scene = SceneWithFiles();
  ForEachMessage<v1::FileRef>(scene, "", [&](v1::FileRef& file, const std::string& path) { file.set_asset(path); });
  EXPECT_EQ(scene.bodies(0).mesh().image().more_files(1).asset(), "bodies[0].mesh.image.more_files[1]");
  EXPECT_EQ(scene.bodies(1).activation_scale().asset(), "bodies[1].activation_scale");
}

TEST(ForEachMessageTest, NothingIsAddedToTheMessage) {
  v1::Scene scene;
  scene.add_bodies();
  ForEachMessage<v1::FileRef>(scene, "", [](v1::FileRef&, const std::string& path) { FAIL() << path; });
  EXPECT_FALSE(scene.bodies(0).has_mesh());
}

TEST(EnumNamesTest, AreWithoutTheNameOfTheirType) {
  EXPECT_EQ(NameOf(*v1::LengthUnit_descriptor()->FindValueByNumber(v1::LENGTH_UNIT_MM)), "mm");
  EXPECT_EQ(NameOf(*v1::Field_descriptor()->FindValueByNumber(v1::FIELD_VON_MISES_STRESS)), "von_mises_stress");
}

}  // namespace
}  // namespace fascicle
