// `fascicle phantom`, `segment` and `voxelize` as users see them.
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

class SegmentTest : public FascicleTest {
 protected:
  // A label image of a bar of 4 x 2 x 2 voxels of 2 mm, label 3.
  std::string Bar() {
    std::string bytes(8 * 4 * 4, '\0');
    for (int k = 1; k < 3; ++k) {
      for (int j = 1; j < 3; ++j) {
        for (int i = 2; i < 6; ++i) bytes[i + 8 * (j + 4 * k)] = 3;
      }
    }
    return File("bar.mha",
                "ObjectType = Image\nNDims = 3\nBinaryData = True\nElementSpacing = 2 2 2\nDimSize = 8 4 4\n"
                "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n" +
                    bytes);
  }
};

// Minutes of work without the signal.
TEST_F(SegmentTest, CtrlCStopsItWithoutAFile) {
  const std::string arm = folder_ / "arm.mha";
  ASSERT_EQ(Fascicle({"phantom", arm}).exit_code, 0);
  const std::set<std::string> before = Files();
  for (const char* command : {"segment", "voxelize"}) {
    std::vector<std::string> arguments = {Program("fascicle"), command, arm, "--seed", "98,119,35"};
    for (int i = 0; i < 20; ++i) arguments.insert(arguments.end(), {"--filter", "curvature:100"});
    arguments.insert(arguments.end(), {"--out", folder_ / "out.mha", "--picture", folder_ / "out.png"});
    ChildProcess child(arguments);
    ASSERT_TRUE(child.AwaitBlocked(SIGINT));
    child.Signal(SIGINT);
    const Finished finished = child.Wait();
    EXPECT_EQ(finished.exit_code, 4) << finished.err;
    EXPECT_THAT(finished.err, HasSubstr("interrupted"));
    EXPECT_EQ(Files(), before);
  }
}

TEST_F(SegmentTest, ThePhantomsAnconeusIsFound) {
  const Finished made = Fascicle({"phantom", File("arm.mha"), "--truth", File("truth.mha")});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("voxel 98,119,35"));
  const Finished found = Fascicle({"segment", File("arm.mha"), "--filter", "wavelet", "--seed", "98,119,35",
                                   "--opening", "0.6", "--out", File("anconeus.nii.gz"), "--picture",
                                   File("anconeus.png"), "--truth", File("truth.mha"), "--truth-label", "4", "--json"});
  ASSERT_EQ(found.exit_code, 0) << found.err << found.out;
  const json report = json::parse(found.out);
  EXPECT_GE(report["dice"].get<double>(), 0.95);
  EXPECT_EQ(report["classes"].size(), 3u);
  EXPECT_EQ(report["wanted_class"], 1);
  EXPECT_EQ(ReadFile(File("anconeus.png")).substr(1, 3), "PNG");
  // The written body is the same.
  const Finished levels = Fascicle({"voxelize", File("anconeus.nii.gz"), "--mask", "--json"});
  ASSERT_EQ(levels.exit_code, 0) << levels.err << levels.out;
  const json table = json::parse(levels.out)["levels"];
  ASSERT_EQ(table.size(), 5u);
  EXPECT_EQ(table[0]["voxels"], report["body"]["voxels"]);
  EXPECT_EQ(table[4]["voxel_size"], 16);
}

TEST_F(SegmentTest, TellsWhatItFound) {
  const Finished found = Fascicle({"segment", Bar(), "--label", "3", "--picture", File("bar.png")});
  EXPECT_EQ(found.exit_code, 0) << found.err;
  EXPECT_THAT(found.out, AllOf(HasSubstr("8 x 4 x 4 voxels of 2 x 2 x 2 mm"), HasSubstr("label 3"), HasSubstr("body"),
                               HasSubstr("16"), HasSubstr("0.1280")));
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path())) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path();
  }
}

// The bar is 8 x 4 x 4 mm from x = 3 mm, with the centre of the first voxel at 0.
TEST_F(SegmentTest, TellsWhereTheBodyIs) {
  const Finished found = Fascicle({"segment", Bar(), "--label", "3"});
  EXPECT_THAT(found.out,
              AllOf(HasSubstr("box       x 3 to 11, y 1 to 5, z 1 to 5 mm"), HasSubstr("middle    7, 3, 3 mm")));
  const json report = json::parse(Fascicle({"voxelize", Bar(), "--label", "3", "--json"}).out);
  EXPECT_NEAR(report["box"]["min"][0], 0.003, 1e-12);
  EXPECT_NEAR(report["middle"][2], 0.003, 1e-12);
}

// From a scan to a job in two commands: the supported end carries the load.
TEST_F(SegmentTest, ASceneOfWhatWasFoundRuns) {
  for (const char* command : {"segment", "voxelize"}) {
    fs::create_directories(folder_ / "a");
    const Finished made =
        Fascicle({command, Bar(), "--label", "3", "--out", File("a/body.mha"), "--scene", File("bar.json")});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const Finished run = Fascicle({"run", File("bar.json"), "--json"});
    ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
    const json series = json::parse(run.out)["series"];
    EXPECT_NEAR(series["body/reaction/lower/x"]["final"], -10, 0.01) << command;
    EXPECT_GT(series["probe/upper/x"]["final"], 0);
  }
  EXPECT_EQ(Fascicle({"segment", Bar(), "--label", "3", "--scene", File("x.json")}).exit_code, 2) << "needs --out";
}

TEST_F(SegmentTest, PicturesCanBeCroppedAndWindowed) {
  const Finished drawn =
      Fascicle({"segment", Bar(), "--label", "3", "--picture", File("bar.png"), "--window", "1", "4", "--crop", "2"});
  EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_EQ(Fascicle({"segment", Bar(), "--label", "3", "--crop", "2"}).exit_code, 2) << "nothing to crop";
  EXPECT_EQ(Fascicle({"segment", Bar(), "--label", "3", "--picture", File("bar.png"), "--window", "1", "0"}).exit_code,
            2);
}

TEST_F(SegmentTest, LevelsAsATable) {
  const Finished table = Fascicle({"voxelize", Bar(), "--label", "3", "--level", "1", "--out", File("coarse.mha"),
                                   "--picture", File("coarse.png")});
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_THAT(table.out, AllOf(HasSubstr("voxel size"), HasSubstr("4 x 4 x 4"), HasSubstr("45"), HasSubstr("12")));
  const Finished again = Fascicle({"voxelize", File("coarse.mha"), "--mask", "--json"});
  const json levels = json::parse(again.out)["levels"];
  EXPECT_EQ(levels[0]["voxels"], 2);
  EXPECT_EQ(levels[0]["nodes"], 12);
  EXPECT_TRUE(fs::exists(File("coarse.png")));
}

TEST_F(SegmentTest, TellsAllMistakesAtOnceAndWritesNothing) {
  File("empty.mha", "");
  const Finished wrong =
      Fascicle({"segment", File("empty.mha"), "--json", "--out", File("x.mha"), "--region", "1,2", "--filter",
                "sharpen", "--filter", "curvature:0", "--seed", "1,2,x", "--thresholds", "2,1"});
  EXPECT_EQ(wrong.exit_code, 2);
  const json error = json::parse(wrong.out);
  EXPECT_EQ(error["reason"], "INVALID_IMAGE");
  std::vector<std::string> paths;
  for (const json& problem : error["problems"]) paths.push_back(problem["path"]);
  EXPECT_THAT(paths, ::testing::UnorderedElementsAre("--region", "--filter", "--filter", "--seed", "--thresholds",
                                                     File("empty.mha")));
  EXPECT_FALSE(fs::exists(File("x.mha")));
  EXPECT_EQ(Fascicle({"segment", File("none.mha"), "--mask"}).exit_code, 2);
  EXPECT_EQ(Fascicle({"segment", Bar(), "--label", "4"}).exit_code, 2);
  EXPECT_EQ(Fascicle({"voxelize", Bar(), "--label", "3", "--level", "4"}).exit_code, 2);
  EXPECT_EQ(Fascicle({"segment", Bar(), "--label", "3", "--out", File("x.png")}).exit_code, 2);
  EXPECT_EQ(Fascicle({"phantom", File("x.png")}).exit_code, 2);
}

TEST_F(SegmentTest, BrightMusclesOfAThigh) {
  const fs::path thigh = testing::DataFolder() / "qmritools_leg_mri/thigh_one_leg_i16.mha";
  if (!fs::exists(thigh)) GTEST_SKIP() << thigh << " is not there; set FASCICLE_DATA";
  const Finished found = Fascicle({"segment", thigh, "--filter", "wavelet", "--class", "2", "--opening", "2",
                                   "--picture", File("thigh.png"), "--json"});
  ASSERT_EQ(found.exit_code, 0) << found.err << found.out;
  // Vasti and adductors over 186 mm; the coil is too far from the other muscles.
  const double volume = json::parse(found.out)["body"]["volume"];
  EXPECT_GT(volume, 1e-3);
  EXPECT_LT(volume, 3e-3);
}

}  // namespace
}  // namespace fascicle::testing
