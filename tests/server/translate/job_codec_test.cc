#include "server/translate/job_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes.h"

namespace fascicle::server {
namespace {

using ::testing::HasSubstr;

TEST(JobCodec, DecodesTheSceneOfASpec) {
  const auto store = MakeMemoryStore();
  const std::string digest = Hex(Sha256Of(kTwoTets));
  v1::Job job;
  *job.mutable_scene() = BoxScene();
  v1::Body& body = *job.mutable_scene()->mutable_bodies(0);
  body.set_unit(v1::LENGTH_UNIT_MM);
  body.mutable_mesh()->mutable_file()->set_path("two.msh");
  body.mutable_mesh()->mutable_file()->set_asset("assets/" + digest);
  body.mutable_regions(1)->set_physical_tag(7);
  const JobCodec codec = MakeJobCodec(nullptr);
  try {
    codec.decode_scene(job.SerializeAsString(), *store, nullptr, {});
    ADD_FAILURE() << "the asset is not there";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("bodies[0].mesh.file"));
  }

  const auto upload = store->BeginUpload(digest, static_cast<std::int64_t>(sizeof(kTwoTets) - 1));
  upload->Write(kTwoTets);
  ASSERT_TRUE(upload->Commit());
  const auto scene = codec.decode_scene(job.SerializeAsString(), *store, nullptr, {});
  ASSERT_NE(scene, nullptr);
  EXPECT_EQ(scene->bodies[0].tet().mesh.tetrahedra.size(), 2u);

  v1::Geometry geometry;
  ASSERT_TRUE(geometry.ParseFromString(codec.encode_geometry(*scene, {})));
  EXPECT_EQ(geometry.bodies(0).name(), "box");
}

TEST(JobCodec, RefusesWhatIsNoJob) {
  const auto store = MakeMemoryStore();
  EXPECT_THROW(MakeJobCodec(nullptr).decode_scene("\xff\xff\xff", *store, nullptr, {}), std::runtime_error);
  EXPECT_THROW(MakeJobCodec(nullptr).decode_scene("", *store, nullptr, {}), std::runtime_error);
}

}  // namespace
}  // namespace fascicle::server
