// Images written and read again, and handmade files: the same voxels at the same positions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/parallel.h"
#include "core/imaging/volume_reader.h"
#include "core/imaging/volume_writer.h"
#include "tests/support/files.h"
#include "tests/support/volume_files.h"
#include "volume_samples.h"

namespace fascicle::testing {
namespace {

using std::filesystem::path;

VolumeImage Read(const std::vector<path>& paths, const VolumeReaderOptions& options = {}) {
  Problems problems;
  const std::optional<VolumeImage> image = ReadVolumeFiles(paths, options, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  return image.value_or(VolumeImage());
}

void ExpectSamePlace(const VolumeImage& image, const VolumeImage& expected, double tolerance) {
  EXPECT_EQ(image.size, expected.size);
  EXPECT_LT((image.spacing - expected.spacing).norm(), tolerance);
  EXPECT_LT((image.origin - expected.origin).norm(), tolerance);
  EXPECT_LT((image.direction - expected.direction).norm(), tolerance);
  EXPECT_LT((image.direction.transpose() * image.direction - Mat3::Identity()).norm(), 1e-14);
}

class RoundTrip : public ::testing::TestWithParam<const char*> {};

TEST_P(RoundTrip, KeepsVoxelsAndPlace) {
  const TemporaryFolder folder;
  const std::string name = std::string("image") + GetParam();
  // NIfTI stores positions as floats of 32 bits [mm].
  const bool nifti = name.find("nii") != std::string::npos || name.find("NII") != std::string::npos;
  const double tolerance = nifti ? 1e-6 : 1e-9;
  VolumeImage image = ObliqueImage();
  for (const bool left_handed : {false, true}) {
    if (left_handed) image.direction.col(1) = -image.direction.col(1);
    for (const VoxelType type : {VoxelType::kInt16, VoxelType::kInt32, VoxelType::kFloat32, VoxelType::kFloat64}) {
      Problems problems;
      WriteVolume(image, type, folder / name, problems);
      ASSERT_TRUE(problems.empty()) << problems.ToString();
      const VolumeImage read = Read({folder / name});
      ExpectSamePlace(read, image, tolerance);
      EXPECT_EQ(read.values, image.values) << NameOf(type);
      // From bytes of any origin.
      const std::string bytes = ReadFile(folder / name);
      const std::optional<VolumeImage> again = ReadVolume({{"/a/b/" + name, bytes}}, {}, problems);
      ASSERT_TRUE(again) << problems.ToString();
      EXPECT_EQ(again->values, image.values);
    }
  }
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, 1u) << "nothing is left beside";
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip, ::testing::Values(".mha", ".nrrd", ".nii", ".nii.gz", ".NII.GZ"),
                         [](const auto& format) {
                           std::string name = format.param;
                           std::erase(name, '.');
                           return name;
                         });

TEST(VolumeWriter, RoundsAndCutsOffWholeNumbers) {
  const TemporaryFolder folder;
  VolumeImage image = ObliqueImage();
  image.values[0] = -3.6F;
  image.values[1] = 300;
  image.values[2] = 7.4F;
  Problems problems;
  WriteVolume(image, VoxelType::kUint8, folder / "a.mha", problems);
  const VolumeImage read = Read({folder / "a.mha"});
  EXPECT_EQ(read.values[0], 0);
  EXPECT_EQ(read.values[1], 255);
  EXPECT_EQ(read.values[2], 7);
}

TEST(VolumeWriter, TellsWhatCantBeWritten) {
  const TemporaryFolder folder;
  for (const char* name : {"a.dcm", "a.raw", "a.mhd", "a.png", "none/a.mha"}) {
    Problems problems;
    WriteVolume(ObliqueImage(), VoxelType::kInt16, folder / name, problems);
    EXPECT_EQ(problems.count(), 1u) << name;
  }
}

std::string Shorts(std::size_t count, bool big_endian) {
  std::string bytes;
  for (std::size_t v = 0; v < count; ++v)
    bytes += Number<std::int16_t>(static_cast<std::int16_t>(v * 300) - 5000, big_endian);
  return bytes;
}

void ExpectShorts(const VolumeImage& image) {
  ASSERT_EQ(image.values.size(), image.voxels());
  for (std::size_t v = 0; v < image.values.size(); ++v) {
    ASSERT_EQ(image.values[v], static_cast<float>(v * 300) - 5000) << v;
  }
}

// Spacing along the axes, lengths in millimetres; the header `file` precedes the voxels or refers to their file.
constexpr const char* kMeta =
    "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = %ORDER%\nCompressedData = False\n"
    "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 10 20 30\nElementSpacing = 2 3 4\nDimSize = 4 3 2\n"
    "ElementType = MET_SHORT\nElementDataFile = %FILE%\n";
constexpr const char* kNrrd =
    "NRRD0004\n# by hand\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 3 2\n"
    "space directions: (0,2,0) (-3,0,0) (0,0,4)\nkinds: domain domain domain\nendian: %ORDER%\nencoding: raw\n"
    "space origin: (10,20,30)\n%FILE%";

std::string Filled(std::string text, const std::string& order, const std::string& file) {
  text.replace(text.find("%ORDER%"), 7, order);
  return text.replace(text.find("%FILE%"), 6, file);
}

void ExpectByHand(const VolumeImage& image) {
  VolumeImage expected;
  expected.size = {4, 3, 2};
  expected.spacing = {2e-3, 3e-3, 4e-3};
  expected.origin = {10e-3, 20e-3, 30e-3};
  expected.direction << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  ExpectSamePlace(image, expected, 1e-12);
  ExpectShorts(image);
}

TEST(VolumeReader, ReadsEitherByteOrder) {
  const TemporaryFolder folder;
  for (const bool big : {false, true}) {
    const std::string shorts = Shorts(24, big);
    ExpectByHand(Read({folder.Write("a.mha", Filled(kMeta, big ? "True" : "False", "LOCAL") + shorts)}));
    ExpectByHand(Read({folder.Write("a.nrrd", Filled(kNrrd, big ? "big" : "little", "\n") + shorts)}));
    const VolumeImage nifti = Read({folder.Write("a.nii", NiftiBytes({4, 3, 2}, shorts, big))});
    ExpectShorts(nifti);
    // x and y point in the opposite directions in NIfTI's frame.
    EXPECT_LT((nifti.CentreOf({1, 1, 1}) - Vec3(-12e-3, -23e-3, 34e-3)).norm(), 1e-9);
  }
}

TEST(VolumeReader, ReadsHeadersWithTheirFileOfVoxels) {
  const TemporaryFolder folder;
  const std::string shorts = Shorts(24, false);
  const path raw = folder.Write("voxels.raw", shorts);
  const std::string meta = Filled(kMeta, "False", "voxels.raw"),
                    nrrd = Filled(kNrrd, "little", "data file: voxels.raw\n\n");
  ExpectByHand(Read({folder.Write("a.mhd", meta)}));
  ExpectByHand(Read({raw, folder.Write("a.nhdr", nrrd)}));
  Problems problems;
  for (const auto& [name, header] : {std::pair<const char*, const std::string&>{"x/a.mhd", meta}, {"x/a.nhdr", nrrd}}) {
    const std::optional<VolumeImage> image = ReadVolume({{"y/voxels.raw", shorts}, {name, header}}, {}, problems);
    ASSERT_TRUE(image) << problems.ToString();
    ExpectByHand(*image);
  }
  EXPECT_TRUE(problems.empty()) << problems.ToString();
}

// Two files with a slice each, by a list and by a pattern.
TEST(VolumeReader, ReadsVoxelsOfSeveralFiles) {
  const TemporaryFolder folder;
  const std::string shorts = Shorts(24, false);
  folder.Write("s08.raw", shorts.substr(0, 24));
  folder.Write("s10.raw", shorts.substr(24));
  for (const std::string files : {"LIST\ns08.raw\n./s10.raw\n", "s%02d.raw 8 10 2\n"}) {
    ExpectByHand(Read({folder.Write("a.mhd", Filled(kMeta, "False", files))}));
    ExpectByHand(Read({folder.Write("a.nhdr", Filled(kNrrd, "little", "data file: " + files))}));
  }
  Problems problems;
  const std::string header = Filled(kMeta, "False", "LIST\ns08.raw\ns10.raw");
  const auto image =
      ReadVolume({{"s10.raw", shorts.substr(24)}, {"a.mhd", header}, {"s08.raw", shorts.substr(0, 24)}}, {}, problems);
  ASSERT_TRUE(image) << problems.ToString();
  ExpectByHand(*image);
}

TEST(VolumeReader, ReadsTextAsNumbersAndHexadecimalDigits) {
  const TemporaryFolder folder;
  std::string decimals, digits;
  for (int v = 0; v < 24; ++v) decimals += std::to_string(v * 300 - 5000) + (v % 5 == 4 ? "\n" : " ");
  for (const char c : Shorts(24, true)) {
    char two[3];
    std::snprintf(two, sizeof two, "%02X", static_cast<unsigned char>(c));
    digits += std::string(two) + (digits.size() % 60 == 58 ? "\n" : "");
  }
  const auto encoded = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  const std::string meta = Filled(kMeta, "False", "LOCAL"), nrrd = Filled(kNrrd, "big", "\n");
  const std::string ascii = encoded(nrrd, "encoding: raw", "encoding: ascii");
  ExpectByHand(Read({folder.Write("a.mha", encoded(meta, "BinaryData = True", "BinaryData = False") + decimals)}));
  ExpectByHand(Read({folder.Write("a.nrrd", ascii + decimals)}));
  ExpectByHand(Read({folder.Write("b.nrrd", encoded(nrrd, "encoding: raw", "encoding: hex") + digits)}));
  Problems problems;
  EXPECT_FALSE(ReadVolume({{"a.nrrd", ascii + decimals.substr(0, 60)}}, {}, problems));
  EXPECT_THAT(problems.ToString(), ::testing::HasSubstr("numbers of 24"));
}

TEST(VolumeReader, RescalesAsNiftiSays) {
  const TemporaryFolder folder;
  const VolumeImage image = Read({folder.Write("a.nii", NiftiBytes({4, 3, 2}, Shorts(24, false), false, 0.5F, 100))});
  for (std::size_t v = 0; v < 24; ++v)
    ASSERT_FLOAT_EQ(image.values[v], 0.5F * (static_cast<float>(v * 300) - 5000) + 100);
}

TEST(VolumeReader, ReadsRawNumbersOfEveryType) {
  const TemporaryFolder folder;
  const auto expect = [&]<class T>(VoxelType type, T) {
    for (const bool big : {false, true}) {
      std::string bytes = "header";
      for (int v = 0; v < 24; ++v) bytes += Number<T>(static_cast<T>(v * 5), big);
      VolumeReaderOptions options;
      options.raw = RawLayout{{4, 3, 2}, {1e-3, 2e-3, 3e-3}, type, big, 6};
      const VolumeImage image = Read({folder.Write("a.raw", bytes)}, options);
      EXPECT_EQ(image.spacing, Vec3(1e-3, 2e-3, 3e-3));
      for (int v = 0; v < 24; ++v) ASSERT_EQ(image.values[v], static_cast<float>(v * 5)) << NameOf(type);
      EXPECT_EQ(VoxelTypeOf(NameOf(type)), type);
    }
  };
  expect(VoxelType::kUint8, std::uint8_t{});
  expect(VoxelType::kInt8, std::int8_t{});
  expect(VoxelType::kUint16, std::uint16_t{});
  expect(VoxelType::kInt16, std::int16_t{});
  expect(VoxelType::kUint32, std::uint32_t{});
  expect(VoxelType::kInt32, std::int32_t{});
  expect(VoxelType::kFloat32, float{});
  expect(VoxelType::kFloat64, double{});
  expect(VoxelType::kInt64, std::int64_t{});
  expect(VoxelType::kUint64, std::uint64_t{});
  EXPECT_FALSE(VoxelTypeOf("int12"));
}

TEST(VolumeReader, SeveralThreadsReadAtOnce) {
  const TemporaryFolder folder;
  const path meta = folder.Write("a.mha", Filled(kMeta, "False", "LOCAL") + Shorts(24, false));
  const path nifti = folder.Write("a.nii", NiftiBytes({4, 3, 2}, Shorts(24, false), false));
  ThreadTeam team(4);
  std::vector<VolumeImage> images(64);
  team.For(images.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      Problems problems;
      images[n] = ReadVolumeFiles({n % 2 == 0 ? meta : nifti}, {}, problems).value_or(VolumeImage());
    }
  });
  for (const VolumeImage& image : images) ExpectShorts(image);
}

}  // namespace
}  // namespace fascicle::testing
