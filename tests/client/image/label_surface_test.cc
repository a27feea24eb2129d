#include "client/image/label_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <string>

#include "tests/support/files.h"
#include "tests/support/volume_files.h"

namespace fascicle::client {
namespace {

using ::fascicle::testing::NiftiBytes;
using ::fascicle::testing::Number;
using ::fascicle::testing::TemporaryFolder;
using ::testing::HasSubstr;

using Labels = std::function<int(const Vec3&)>;  // of a voxel, by its index

// Labels of all voxels as T, x fastest.
template <class T>
std::string Voxels(const GridIndex& size, const Labels& label) {
  std::string bytes;
  for (int z = 0; z < size[2]; ++z) {
    for (int y = 0; y < size[1]; ++y) {
      for (int x = 0; x < size[0]; ++x) bytes += Number(static_cast<T>(label(Vec3(x, y, z))));
    }
  }
  return bytes;
}

// A MetaImage as bytes; `header` has the lines on spacing, position and channels.
std::string MetaBytes(const GridIndex& size, const std::string& header, const std::string& voxels) {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n" +
         header + "DimSize = " + std::to_string(size[0]) + " " + std::to_string(size[1]) + " " +
         std::to_string(size[2]) + "\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + voxels;
}

// The level of the surface is bisected eight times: where a label is as thin as the blur, its volume is less exact.
constexpr double kThin = 0.015;

constexpr GridIndex kSize = {20, 40, 12};
constexpr const char* kTurned =
    "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 100 200 300\nElementSpacing = 1 0.5 2\n";

// With voxels of 1 x 0.5 x 2, label 3 is a ball of radius 4 around the point (9, 10, 11), and label 1 all below z = 1.
int BallAndFloor(const Vec3& index) {
  const Vec3 x = index.cwiseProduct(Vec3(1, 0.5, 2));
  return (x - Vec3(9, 10, 11)).norm() < 4 ? 3 : x[2] < 1 ? 1 : 0;
}
std::string BallImage() { return MetaBytes(kSize, kTurned, Voxels<std::uint8_t>(kSize, BallAndFloor)); }

std::optional<LabelSurface> Read(const std::string& name, const std::string& bytes, int label, double smoothing,
                                 Problems& problems) {
  const TemporaryFolder folder;
  return ReadLabelSurface(folder.Write(name, bytes), label, smoothing, {}, problems);
}

LabelSurface ReadGood(const std::string& name, const std::string& bytes, int label, double smoothing = 0.6) {
  Problems problems;
  const auto result = Read(name, bytes, label, smoothing, problems);
  EXPECT_TRUE(result && problems.empty()) << problems.ToString();
  return result.value_or(LabelSurface{});
}

std::string Refusal(const std::string& name, const std::string& bytes, int label = 3, double smoothing = 0.6) {
  Problems problems;
  EXPECT_FALSE(Read(name, bytes, label, smoothing, problems)) << name;
  EXPECT_EQ(problems.count(), 1u) << problems.ToString();
  return problems.ToString();
}

struct Box {
  Vec3 low, high;
};
Box BoxOf(const TriangleMesh& surface) {
  Box box = {surface.nodes.at(0), surface.nodes.at(0)};
  for (const Vec3& node : surface.nodes) {
    box.low = box.low.cwiseMin(node);
    box.high = box.high.cwiseMax(node);
  }
  return box;
}

// Each edge belongs to two triangles, which have it in opposite directions.
bool IsClosed(const TriangleMesh& surface) {
  std::map<std::array<std::int32_t, 2>, int> passed;
  for (const Triangle& t : surface.triangles) {
    for (int c = 0; c < 3; ++c) ++passed[{t[c], t[(c + 1) % 3]}];
  }
  return std::all_of(passed.begin(), passed.end(), [&](const auto& edge) {
    const auto opposite = passed.find({edge.first[1], edge.first[0]});
    return edge.second == 1 && opposite != passed.end();
  });
}

TEST(IsImagePath, KnowsExtensionsAndFolders) {
  for (const char* name : {"a.mha", "a.MHD", "b/c.nii", "a.nii.gz", "A.NII.GZ", "a.nrrd", "a.nhdr", "a.hdr", "a.dcm"}) {
    EXPECT_TRUE(IsImagePath(name)) << name;
  }
  for (const char* name : {"a.stl", "mha", "a.gz", "a.mha.txt", ""}) EXPECT_FALSE(IsImagePath(name)) << name;
  EXPECT_TRUE(IsImagePath(TemporaryFolder().path()));
}

TEST(LabelSurface, IsClosedAndEnclosesAsMuchAsTheVoxels) {
  double voxels = 0;
  Voxels<std::uint8_t>(kSize, [&](const Vec3& index) {
    voxels += BallAndFloor(index) == 3;
    return 0;
  });
  for (const double smoothing : {0.3, 0.6, 1.5}) {
    const LabelSurface ball = ReadGood("ball.mha", BallImage(), 3, smoothing);
    EXPECT_NEAR(ball.voxel_volume, voxels * 1 * 0.5 * 2, 1e-9);
    EXPECT_NEAR(ball.surface_volume / ball.voxel_volume, 1, smoothing < 1 ? 5e-3 : kThin) << smoothing;
    EXPECT_DOUBLE_EQ(ball.surface_volume, EnclosedVolume(ball.surface)) << "outwards";
    EXPECT_TRUE(IsClosed(ball.surface)) << smoothing;
    EXPECT_GT(ball.surface.triangles.size(), 500u);
  }
}

// The axes of the image are rotated by a right angle: its x runs along y of space, its y against x.
TEST(LabelSurface, AMetaImageLiesWhereItsHeaderSays) {
  const Box box = BoxOf(ReadGood("ball.mha", BallImage(), 3).surface);
  const Vec3 centre(100 - 10, 200 + 9, 300 + 11);
  EXPECT_LT((0.5 * (box.low + box.high) - centre).cwiseAbs().maxCoeff(), 0.1);
  EXPECT_LT((box.high - box.low - Vec3::Constant(8)).cwiseAbs().maxCoeff(), 1);
}

// Voxel (i, j, k) is at (10 + 2 i, 20 + 3 j, 30 + 4 k) mm in NIfTI's frame, whose x and y point the other way.
TEST(LabelSurface, ANiftiImageLiesWhereItsSformSays) {
  const GridIndex size = {10, 9, 8};
  const auto block = [](const Vec3& i) { return i[0] >= 2 && i[0] < 7 && i[1] >= 3 && i[1] < 6 && i[2] >= 4 ? 2 : 0; };
  const LabelSurface surface =
      ReadGood("block.nii", NiftiBytes(size, Voxels<std::int16_t>(size, block), false), 2, 0.3);
  EXPECT_NEAR(surface.voxel_volume, 5 * 3 * 4 * 24, 1e-9);
  const Box box = BoxOf(surface.surface);
  EXPECT_LT((0.5 * (box.low + box.high) - Vec3(-10 - 2 * 4, -20 - 3 * 4, 30 + 4 * 5.5)).cwiseAbs().maxCoeff(), 0.05);
  EXPECT_LT((box.high - box.low - Vec3(5 * 2, 3 * 3, 4 * 4)).cwiseAbs().maxCoeff(), 1.5);
}

// If a label reaches the border of the image, the surface is closed there too.
TEST(LabelSurface, ALabelAtTheSideIsClosed) {
  const LabelSurface floor = ReadGood("ball.mha", BallImage(), 1);
  EXPECT_NEAR(floor.voxel_volume, 20 * 40 * 1, 1e-9);
  EXPECT_NEAR(floor.surface_volume / floor.voxel_volume, 1, kThin);
  EXPECT_TRUE(IsClosed(floor.surface));
}

TEST(LabelSurface, SmoothingRoundsCorners) {
  const GridIndex size = {24, 24, 24};
  const auto cube = [](const Vec3& i) { return i.minCoeff() >= 6 && i.maxCoeff() < 18 ? 1 : 0; };
  const std::string image = MetaBytes(size, "ElementSpacing = 1 1 1\n", Voxels<std::uint8_t>(size, cube));
  double last = std::sqrt(3.0) * 6;  // half of a diagonal
  for (const double smoothing : {0.5, 1.0, 2.0}) {
    const LabelSurface surface = ReadGood("cube.mha", image, 1, smoothing);
    double furthest = 0;
    for (const Vec3& node : surface.surface.nodes) furthest = std::max(furthest, (node - Vec3::Constant(11.5)).norm());
    EXPECT_LT(furthest, last - 0.2 * smoothing) << smoothing;
    EXPECT_GT(furthest, 6 * std::cbrt(6 / 3.14159265358979)) << "a ball of the same volume";
    last = furthest;
  }
}

TEST(LabelSurface, SaysWhichLabelsThereAre) {
  EXPECT_THAT(Refusal("ball.mha", BallImage(), 7), HasSubstr("no voxel has the label 7 (existing labels: 1, 3)"));
  const std::string nothing = MetaBytes(kSize, kTurned, std::string(20 * 40 * 12, '\0'));
  EXPECT_THAT(Refusal("nothing.mha", nothing), HasSubstr("all voxels are 0"));
}

TEST(LabelSurface, RefusesWhatIsNoLabelImage) {
  const std::string whole = BallImage();
  for (const std::string& bytes : {whole.substr(0, 100), std::string("nothing"), std::string()}) {
    for (const char* name : {"broken.mha", "broken.nii", "broken.nii.gz"}) {
      EXPECT_THAT(Refusal(name, bytes), HasSubstr("is it complete, and is it what its extension says?")) << name;
    }
  }
  const std::string pairs =
      MetaBytes({2, 2, 2}, "ElementNumberOfChannels = 2\nElementSpacing = 1 1 1\n", std::string(16, '\3'));
  EXPECT_THAT(Refusal("pairs.mha", pairs), HasSubstr("2 components a voxel"));
}

TEST(LabelSurface, SaysThatSmoothingLeavesNothing) {
  const auto speck = [](const Vec3& index) { return index == Vec3(9, 20, 6) ? 3 : 0; };
  const std::string image = MetaBytes(kSize, kTurned, Voxels<std::uint8_t>(kSize, speck));
  EXPECT_THAT(Refusal("speck.mha", image, 3, 10), HasSubstr("1 voxels, all of which disappear by smoothing"));
}

}  // namespace
}  // namespace fascicle::client
