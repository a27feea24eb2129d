// Results of long stages are computed once, and scenes do not depend on the cache.
#include "server/translate/result_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <latch>
#include <stdexcept>
#include <thread>

#include "core/base/digest.h"
#include "core/base/stop.h"
#include "core/sim/fingerprint.h"
#include "scenes.h"
#include "server/translate/kept_results.h"

namespace fascicle::server {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

struct Text {
  std::string text;
  void WriteTo(ArchiveWriter& archive) const { archive.PutString("text", text); }
  void ReadFrom(ArchiveReader& archive) { text = archive.GetString("text"); }
};

ArchiveWriter Input(std::int64_t number) {
  ArchiveWriter inputs("stage", 1);
  inputs.PutInt("number", number);
  return inputs;
}

class ResultCacheTest : public ::testing::Test {
 protected:
  std::optional<Text> Get(std::int64_t number) {
    return cache_.GetOrCompute<Text>(Input(number), {}, [&]() -> std::optional<Text> {
      ++computed_;
      if (number < 0) return std::nullopt;
      return Text{"result " + std::to_string(number)};
    });
  }

  const std::unique_ptr<ResultStore> store_ = MakeMemoryResults(1 << 20);
  ResultCache cache_ = ResultCache(*store_);
  std::atomic<int> computed_ = 0;
};

TEST_F(ResultCacheTest, ComputesEachResultOnce) {
  for (int round = 0; round < 3; ++round) {
    for (const int number : {1, 2}) EXPECT_EQ(Get(number)->text, "result " + std::to_string(number));
  }
  EXPECT_EQ(computed_, 2);
  // Another cache finds them in the store.
  ResultCache other(*store_);
  const auto none = []() -> std::optional<Text> { throw std::logic_error("it is there"); };
  EXPECT_EQ(other.GetOrCompute<Text>(Input(1), {}, none)->text, "result 1");
}

TEST_F(ResultCacheTest, WhatDoesNotComeAboutIsNotKept) {
  EXPECT_FALSE(Get(-1));
  EXPECT_FALSE(Get(-1));
  EXPECT_EQ(computed_, 2);
  const auto fail = []() -> std::optional<Text> { throw Stopped(); };
  EXPECT_THROW(cache_.GetOrCompute<Text>(Input(1), {}, fail), Stopped);
  EXPECT_EQ(Get(1)->text, "result 1");
}

TEST_F(ResultCacheTest, KindVersionAndInputsTellResultsApart) {
  const auto get = [&](ArchiveWriter inputs) {
    cache_.GetOrCompute<Text>(std::move(inputs), {}, [&]() -> std::optional<Text> {
      ++computed_;
      return Text();
    });
  };
  get(ArchiveWriter("stage", 1));
  get(ArchiveWriter("stage", 2));
  get(ArchiveWriter("another stage", 1));
  get(Input(1));
  get(Input(2));
  EXPECT_EQ(computed_, 5);
}

TEST_F(ResultCacheTest, ThreadsThatAskAtOnceComputeOnce) {
  constexpr int kThreads = 4;
  std::latch all(kThreads);
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&] {
      all.arrive_and_wait();
      EXPECT_EQ(Get(7)->text, "result 7");
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(computed_, 1);
}

TEST_F(ResultCacheTest, WhoWaitsForAnotherThreadHeedsItsStopRequest) {
  std::latch begun(1), go_on(1);
  std::thread slow([&] {
    cache_.GetOrCompute<Text>(Input(1), {}, [&]() -> std::optional<Text> {
      begun.count_down();
      go_on.wait();
      return Text{"slow"};
    });
  });
  begun.wait();
  std::stop_source source;
  std::thread stopper([&] { source.request_stop(); });
  const auto none = []() -> std::optional<Text> { throw std::logic_error("another thread computes it"); };
  EXPECT_THROW(cache_.GetOrCompute<Text>(Input(1), source.get_token(), none), Stopped);
  stopper.join();
  go_on.count_down();
  slow.join();
  EXPECT_EQ(Get(1)->text, "slow");
}

// A store with an entry that may be anything.
class Garbage final : public ResultStore {
 public:
  std::optional<std::string> GetResult(std::string_view) override { return bytes; }
  void PutResult(std::string_view, std::string_view put) override { bytes = put; }
  std::string bytes = "garbage";
};

TEST(ResultCache, ComputesAgainWhatCannotBeRead) {
  Garbage store;
  ResultCache cache(store);
  const auto compute = []() -> std::optional<Text> { return Text{"right"}; };
  EXPECT_EQ(cache.GetOrCompute<Text>(Input(1), {}, compute)->text, "right");
  // The entry was replaced.
  const auto none = []() -> std::optional<Text> { throw std::logic_error("it is there"); };
  EXPECT_EQ(cache.GetOrCompute<Text>(Input(1), {}, none)->text, "right");
  // A valid archive that lacks the required values.
  ArchiveWriter other("result", 1);
  store.bytes = other.Finish();
  EXPECT_EQ(cache.GetOrCompute<Text>(Input(1), {}, compute)->text, "right");
}

// --- Scenes ----------------------------------------------------------------------------------------------------------

// A part of the phantom around the anconeus.
v1::Scene PhantomScene() {
  return ParseText(R"(
    name: "anconeus" duration: 1 voxel {} output { frame_interval: 1 }
    bodies {
      name: "anconeus" unit: LENGTH_UNIT_MM
      mesh {
        image {
          phantom {} region { first: [70, 90, 20] size: [60, 60, 30] } filters { wavelet {} } classes {}
          seeds { point: [49, 60, 17.75] } cleaning { opening: 0.6 } level: 1
        }
      }
      material { linear_elastic { young_modulus: 1e4 } }
      regions { name: "lower" plane { point: [0, 0, 12] normal: [0, 0, -1] } }
      constraints { region: "lower" }
    })");
}

v1::Scene FibreScene(const std::string& fibres) {
  v1::Scene scene = BoxScene();
  EXPECT_TRUE(google::protobuf::TextFormat::MergeFromString("fibres { " + fibres + " }", scene.mutable_bodies(0)));
  return scene;
}
const char kHarmonic[] = R"(harmonic { origin: "bottom" insertion: "top" })";
const char kFitted[] =
    R"(bspline { fitted { origin: "bottom" insertion: "top" degrees: [1, 1, 2] controls: [2, 2, 5] } })";

// A scene's stages and fingerprint.
struct Translated {
  std::shared_ptr<const Scene> scene;
  std::vector<std::string> stages;
};

Translated TranslateWith(ResultCache* cache, const v1::Scene& scene, const Files& files = {}) {
  Profile profile;
  Problems problems;
  auto translated = TranslateScene(scene, files.reader(), problems, {}, {&profile, cache, {}});
  EXPECT_NE(translated, nullptr) << problems.ToString();
  Translated result{std::move(translated), {}};
  for (const ProfileStage& stage : profile.Stages()) result.stages.push_back(stage.name);
  return result;
}

struct LongStage {
  const char* stage;
  v1::Scene scene;
  const char* digest;  // of the cached result
};

class EveryLongStage : public ::testing::TestWithParam<int> {
 protected:
  static LongStage Stage(int number) {
    switch (number) {
      case 0:
        return {"meshes/segmentation", PhantomScene(),
                "3eac14d0f754cd26f508fe06f20b3b24ab16302bcd2749930e15de5204119ddf"};
      case 1:
        return {"fibres/harmonic", FibreScene(kHarmonic),
                "3a50acafad79b17fc152b7ce7c6cab56942282b99975c1e4b96f09ae86b20200"};
      default:
        return {"fibres/bspline", FibreScene(kFitted),
                "11f550d09094302221dca86f69982f202488f5a2cf65b2fe313a8fc60ec4aa00"};
    }
  }

  const LongStage stage_ = Stage(GetParam());
  const std::unique_ptr<ResultStore> store_ = MakeMemoryResults(1 << 24);
};

TEST_P(EveryLongStage, IsRunOnceAndTheSceneIsTheSame) {
  const Translated without = TranslateWith(nullptr, stage_.scene);
  EXPECT_THAT(without.stages, Contains(stage_.stage));
  ResultCache cache(*store_);
  const Translated first = TranslateWith(&cache, stage_.scene);
  EXPECT_THAT(first.stages, Contains(stage_.stage));
  ResultCache after_restart(*store_);
  const Translated second = TranslateWith(&after_restart, stage_.scene);
  EXPECT_THAT(second.stages, Not(Contains(stage_.stage)));
  const Digest expected = FingerprintOf(*without.scene);
  EXPECT_EQ(Hex(FingerprintOf(*first.scene)), Hex(expected));
  EXPECT_EQ(Hex(FingerprintOf(*second.scene)), Hex(expected));
  EXPECT_EQ(second.scene->bodies[0].notes, without.scene->bodies[0].notes);
}

// The store as it is, and the last stored result.
class Recording final : public ResultStore {
 public:
  std::optional<std::string> GetResult(std::string_view) override { return std::nullopt; }
  void PutResult(std::string_view, std::string_view put) override { bytes = put; }
  std::string bytes;
};

TEST_P(EveryLongStage, AnotherResultNeedsAnotherVersion) {
  Recording store;
  ResultCache cache(store);
  TranslateWith(&cache, stage_.scene);
  EXPECT_EQ(Hex(Sha256Of(store.bytes)), stage_.digest)
      << "The stage gives another result than before: raise its kVersion, so that no result that a server has kept is "
         "taken for it, and then this digest.";
}

TEST_P(EveryLongStage, HeedsStopRequests) {
  std::stop_source source;
  source.request_stop();
  Problems problems;
  EXPECT_THROW(TranslateScene(stage_.scene, {}, problems, {}, {nullptr, nullptr, source.get_token()}), Stopped);
  EXPECT_TRUE(problems.empty());
}

INSTANTIATE_TEST_SUITE_P(Results, EveryLongStage, ::testing::Range(0, 3));

TEST(KeptResults, WhatIsWrongIsSaidEachTime) {
  const auto store = MakeMemoryResults(1 << 24);
  ResultCache cache(*store);
  v1::Scene scene = PhantomScene();
  scene.mutable_bodies(0)->mutable_mesh()->mutable_image()->mutable_seeds(0)->set_point(0, 30);
  for (int round = 0; round < 2; ++round) {
    Problems problems;
    EXPECT_EQ(TranslateScene(scene, {}, problems, {}, {nullptr, &cache, {}}), nullptr);
    EXPECT_THAT(problems.ToString(), HasSubstr("bodies[0].mesh.image.seeds[0]"));
  }
}

// Different regions or meshes give different fibres.
TEST(KeptResults, ChangesOfWhatAStageDependsOnAreSeen) {
  const auto store = MakeMemoryResults(1 << 24);
  ResultCache cache(*store);
  std::vector<v1::Scene> scenes(4, FibreScene(kHarmonic));
  scenes[1].mutable_bodies(0)->mutable_mesh()->mutable_box()->set_size(2, 5);
  scenes[1].mutable_bodies(0)->mutable_regions(1)->mutable_plane()->set_point(2, 5);
  scenes[2].mutable_bodies(0)->set_unit(v1::LENGTH_UNIT_MM);
  scenes[3].mutable_bodies(0)->mutable_regions(1)->mutable_plane()->set_point(2, 2.9);
  for (const v1::Scene& scene : scenes) {
    EXPECT_THAT(TranslateWith(&cache, scene).stages, Contains("fibres/harmonic"));
    EXPECT_THAT(TranslateWith(&cache, scene).stages, Not(Contains("fibres/harmonic")));
  }
  // The result does not depend on other fields.
  scenes[0].mutable_bodies(0)->set_density(500);
  scenes[0].set_duration(2);
  EXPECT_THAT(TranslateWith(&cache, scenes[0]).stages, Not(Contains("fibres/harmonic")));
}

TEST(KeptResults, AnImageIsKeptByItsFilesContents) {
  Files files;
  const std::string header =
      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
      "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\nCenterOfRotation = 0 0 0\nElementSpacing = 1 1 1\n"
      "DimSize = 3 2 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
  v1::Scene scene = ParseText(R"(
    name: "scan" duration: 1 voxel {} output { frame_interval: 1 }
    bodies {
      name: "muscle" unit: LENGTH_UNIT_MM
      mesh { image { file { path: "scan.mha" } labels { values: 1 } cleaning { keep: KEPT_PARTS_ALL } } }
      material { linear_elastic { young_modulus: 1e4 } }
      regions { name: "left" plane { point: [0, 0, 0] normal: [-1, 0, 0] } }
      constraints { region: "left" }
    })");
  const auto store = MakeMemoryResults(1 << 24);
  ResultCache cache(*store);
  const auto bricks = [&](const char* voxels) {
    v1::FileRef& file = *scene.mutable_bodies(0)->mutable_mesh()->mutable_image()->mutable_file();
    file.set_asset(files.Add(header + std::string(voxels, 6)));
    return TranslateWith(&cache, scene, files).scene->bodies[0].voxel().mesh.bricks.size();
  };
  EXPECT_EQ(bricks("\1\1\1\1\1\1"), 6u);
  EXPECT_EQ(bricks("\1\1\1\1\1\0"), 5u);
  EXPECT_EQ(bricks("\1\1\1\1\1\1"), 6u);
}

}  // namespace
}  // namespace fascicle::server
