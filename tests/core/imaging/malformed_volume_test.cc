// Files that are not images, or incomplete: reported in plain words, with nothing read and no large allocation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/imaging/volume_reader.h"
#include "core/imaging/volume_writer.h"
#include "tests/support/files.h"
#include "tests/support/volume_files.h"
#include "volume_samples.h"

namespace fascicle::testing {
namespace {

using std::filesystem::path;
using ::testing::HasSubstr;

std::string Refusal(const std::string& name, const std::string& bytes, const VolumeReaderOptions& options = {}) {
  Problems problems;
  EXPECT_FALSE(ReadVolume({{name, bytes}}, options, problems)) << name;
  EXPECT_FALSE(problems.empty()) << name;
  for (const Problem& problem : problems.kept()) {
    EXPECT_EQ(problem.path, "");
    EXPECT_THAT(problem.message, Not(HasSubstr("/tmp")));
  }
  return problems.ToString();
}

std::string Meta(const std::string& size, const std::string& more = "", const std::string& file = "LOCAL") {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nDimSize = " + size + "\n" + more +
         "ElementType = MET_SHORT\nElementDataFile = " + file + "\n";
}

std::string Nrrd(const std::string& size, const std::string& more = "encoding: raw\n") {
  return "NRRD0004\ntype: short\ndimension: 3\nsizes: " + size + "\nendian: little\n" + more + "\n";
}

const std::string kVoxels(2 * 4 * 3 * 2, '\1');

TEST(MalformedVolume, TheSamplesAreRightWithoutTheirMistakes) {
  for (const auto& [name, bytes] :
       std::vector<std::pair<std::string, std::string>>{{"a.mha", Meta("4 3 2") + kVoxels},
                                                        {"a.nrrd", Nrrd("4 3 2") + kVoxels},
                                                        {"a.nii", NiftiBytes({4, 3, 2}, kVoxels, false)},
                                                        {"a.dcm", DicomBytes({})}}) {
    Problems problems;
    EXPECT_TRUE(ReadVolume({{name, bytes}}, {}, problems)) << name << problems.ToString();
  }
}

// ITK's matrix library ends the program on these.
TEST(MalformedVolume, PlacesThatAreNoNumbers) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  constexpr std::size_t kSpacing = 80, kQuaternion = 256, kOffset = 268, kMatrix = 280;
  for (const bool big_endian : {false, true}) {
    const auto with = [&](std::size_t at, const std::vector<float>& values) {
      std::string bytes = NiftiBytes({4, 3, 2}, kVoxels, big_endian);
      for (const float value : values) {
        bytes.replace(at, sizeof(float), Number<float>(value, big_endian));
        at += sizeof(float);
      }
      return bytes;
    };
    for (const std::string& bytes :
         {with(kSpacing, {-kInfinity}), with(kSpacing + 8, {kNan}), with(kSpacing, {1e30F}), with(kSpacing, {1e-30F}),
          with(kQuaternion, {kNan}), with(kOffset + 8, {kInfinity}), with(kMatrix, {kNan}), with(kMatrix + 16, {1e38F}),
          with(kMatrix, std::vector<float>(12, 0)), with(kMatrix, std::vector<float>(12, 1e-30F))}) {
      EXPECT_THAT(Refusal("a.nii", bytes), HasSubstr("the image's position"));
    }
  }
}

TEST(MalformedVolume, Huge) {
  EXPECT_THAT(Refusal("a.mha", Meta("10000 10000 10000") + kVoxels), HasSubstr("10000 x 10000 x 10000 voxels"));
  EXPECT_THAT(Refusal("a.nrrd", Nrrd("10000 10000 10000") + kVoxels), HasSubstr("10000 x 10000 x 10000 voxels"));
  EXPECT_THAT(Refusal("a.nii", NiftiBytes({10000, 10000, 10000}, kVoxels, false)), HasSubstr("voxels"));
  // Below 2^31, but far more than the file can contain, compressed or not.
  EXPECT_THAT(Refusal("a.mha", Meta("1000 1000 1000") + kVoxels), HasSubstr("the file is too short"));
  const TemporaryFolder folder;
  Problems written;
  WriteVolume(ObliqueImage(), VoxelType::kInt16, folder / "a.mha", written);
  std::string compressed = ReadFile(folder / "a.mha");
  compressed.replace(compressed.find("DimSize = 7 5 4"), 15, "DimSize = 700 500 400");
  EXPECT_THAT(Refusal("a.mha", compressed), HasSubstr("the file is too short"));
  EXPECT_THAT(Refusal("a.mha", Meta("4 3 2", "CompressedData = True\nCompressedDataSize = 1000000000000\n") + kVoxels),
              HasSubstr(""));
  EXPECT_THAT(Refusal("a.nrrd", Nrrd("1000 1000 1000", "encoding: gzip\n") + kVoxels),
              HasSubstr("the file is too short"));
  EXPECT_THAT(Refusal("a.nii", NiftiBytes({1000, 1000, 1000}, kVoxels, false)), HasSubstr("the file is too short"));
  EXPECT_THAT(Refusal("a.mha", Meta("99999999999999999999 3 2") + kVoxels), HasSubstr(""));
  VolumeReaderOptions small;
  small.memory_limit = 100;
  EXPECT_THAT(Refusal("a.mha", Meta("4 3 2") + kVoxels, small), HasSubstr("are allowed"));
  DicomSlice slice;
  std::string dicom = DicomBytes(slice);
  const std::string rows = Number<std::uint16_t>(0x28) + Number<std::uint16_t>(0x10) + "US" + Number<std::uint16_t>(2);
  dicom.replace(dicom.find(rows) + rows.size(), 2, "\xff\xff");
  Refusal("a.dcm", dicom);
}

TEST(MalformedVolume, Empty) {
  for (const char* name : {"a.mha", "a.mhd", "a.nrrd", "a.nhdr", "a.nii", "a.nii.gz", "a.dcm"}) Refusal(name, "");
  EXPECT_THAT(Refusal("a.mha", Meta("4 0 2") + kVoxels), HasSubstr(""));
  Refusal("a.nrrd", Nrrd("4 0 2") + kVoxels);
  Refusal("a.mha", Meta("4 -3 2") + kVoxels);
  Problems problems;
  EXPECT_FALSE(ReadVolume(std::vector<VolumeFile>(), {}, problems));
  EXPECT_EQ(problems.count(), 1u);
}

// A file truncated at any length is refused.
TEST(MalformedVolume, Truncated) {
  const TemporaryFolder folder;
  VolumeImage image = ObliqueImage();
  std::vector<std::pair<std::string, std::string>> files = {{"raw.mha", Meta("4 3 2") + kVoxels},
                                                            {"raw.nrrd", Nrrd("4 3 2") + kVoxels},
                                                            {"raw.nii", NiftiBytes({4, 3, 2}, kVoxels, false)},
                                                            {"raw.dcm", DicomBytes({})}};
  for (const char* name : {"a.mha", "a.nrrd", "a.nii.gz"}) {
    Problems problems;
    WriteVolume(image, VoxelType::kInt16, folder / name, problems);
    files.emplace_back(name, ReadFile(folder / name));
  }
  for (const auto& [name, bytes] : files) {
    Problems whole;
    const std::optional<VolumeImage> complete = ReadVolume({{name, bytes}}, {}, whole);
    ASSERT_TRUE(complete) << name << whole.ToString();
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      Problems problems;
      ASSERT_FALSE(ReadVolume({{name, std::string_view(bytes).substr(0, length)}}, {}, problems))
          << name << " " << length;
      ASSERT_FALSE(problems.empty());
    }
  }
}

TEST(MalformedVolume, Mislabelled) {
  const std::vector<std::pair<std::string, std::string>> files = {{".mha", Meta("4 3 2") + kVoxels},
                                                                  {".nrrd", Nrrd("4 3 2") + kVoxels},
                                                                  {".nii", NiftiBytes({4, 3, 2}, kVoxels, false)},
                                                                  {".dcm", DicomBytes({})}};
  for (const auto& [extension, bytes] : files) {
    for (const auto& [other, unused] : files) {
      if (other != extension) Refusal("a" + other, bytes);
    }
    EXPECT_THAT(Refusal("a.png", bytes.substr(0, 100)), HasSubstr("expected .mha"));
  }
}

TEST(MalformedVolume, TextThatIsNoHeader) {
  EXPECT_THAT(Refusal("a.mha", "NDims = 3\n" + std::string(100000, 'x')), HasSubstr("no header"));
  EXPECT_THAT(Refusal("a.mha", "NDims = 10\nDimSize = 1 1 1\nElementDataFile = LOCAL\n"), HasSubstr("`10` dimensions"));
  EXPECT_THAT(Refusal("a.mha", "DimSize = 1 1 1\nElementDataFile = LOCAL\n"), HasSubstr("no header"));
  EXPECT_THAT(Refusal("a.mha", "just text\n"), HasSubstr("no header"));
  EXPECT_THAT(Refusal("a.nrrd", "NRRD0004\n" + std::string(100000, 'x')), HasSubstr("no header"));
  EXPECT_THAT(Refusal("a.nrrd", "NRRX\n"), HasSubstr("no header"));
}

TEST(MalformedVolume, FilesOfVoxelsElsewhere) {
  for (const char* file : {"/etc/passwd", "../a.raw", "x/a.raw", "..", "LIST", "a%03d.raw 1 3 1"}) {
    Refusal("a.mhd", Meta("4 3 2", "", file));
    Refusal("a.nhdr", Nrrd("4 3 2", "encoding: raw\ndata file: " + std::string(file) + "\n"));
    Refusal("a.mha", Meta("4 3 2", "", file));
  }
  EXPECT_THAT(Refusal("a.mhd", Meta("4 3 2", "", "none.raw")), HasSubstr("none.raw"));
  EXPECT_THAT(Refusal("a.nhdr", Nrrd("4 3 2", "encoding: raw\ndata file: none.raw\n")), HasSubstr("none.raw"));
}

TEST(MalformedVolume, NoVolumeOfOneNumberAVoxel) {
  EXPECT_THAT(Refusal("a.mha", Meta("4 3 2", "ElementNumberOfChannels = 3\n") + kVoxels + kVoxels + kVoxels),
              HasSubstr("3 components"));
  std::string four = Meta("2 3 2 2") + kVoxels;
  four.replace(four.find("NDims = 3"), 9, "NDims = 4");
  EXPECT_THAT(Refusal("a.mha", four), HasSubstr("2 volumes"));
  for (const char* spacing : {"0 1 1", "-1 1 1", "nan 1 1", "inf 1 1", "1 1 1e999"}) {
    Refusal("a.mha", Meta("4 3 2", "ElementSpacing = " + std::string(spacing) + "\n") + kVoxels);
  }
  for (const char* axes : {"1 0 0 1 0 0 0 0 1", "1 0 0 0.5 1 0 0 0 1", "0 0 0 0 0 0 0 0 0", "nan 0 0 0 1 0 0 0 1"}) {
    Refusal("a.mha", Meta("4 3 2", "TransformMatrix = " + std::string(axes) + "\n") + kVoxels);
  }
  Refusal("a.nrrd",
          Nrrd("4 3 2", "encoding: raw\nspace dimension: 3\nspace directions: (1,0,0) (1,1,0) (0,0,1)\n") + kVoxels);
  const TemporaryFolder folder;
  VolumeImage image = ObliqueImage();
  image.values[9] = std::numeric_limits<float>::quiet_NaN();
  image.values[50] = std::numeric_limits<float>::infinity();
  Problems problems;
  WriteVolume(image, VoxelType::kFloat32, folder / "nan.mha", problems);
  EXPECT_THAT(Refusal("nan.mha", ReadFile(folder / "nan.mha")),
              HasSubstr("2 voxels are infinite or not numbers: the first is (2, 1, 0)"));
}

TEST(MalformedVolume, Raw) {
  VolumeReaderOptions options;
  EXPECT_THAT(Refusal("a.raw", kVoxels), HasSubstr("does not say what it holds"));
  options.raw = RawLayout{{4, 3, 2}};
  Problems problems;
  EXPECT_TRUE(ReadVolume({{"a.raw", kVoxels}}, options, problems));
  EXPECT_THAT(Refusal("a.raw", kVoxels + "x", options), HasSubstr("1 bytes more"));
  EXPECT_THAT(Refusal("a.raw", kVoxels.substr(1), options), HasSubstr("too short"));
  options.raw->header_bytes = 100;
  EXPECT_THAT(Refusal("a.raw", kVoxels, options), HasSubstr("too short"));
  options.raw->header_bytes = -1;
  Refusal("a.raw", kVoxels, options);
  options.raw = RawLayout{{4, 0, 2}};
  Refusal("a.raw", kVoxels, options);
  options.raw = RawLayout{{4, 3, 2}, {1e-3, 0, 1e-3}};
  EXPECT_THAT(Refusal("a.raw", kVoxels, options), HasSubstr("no volume"));
}

TEST(MalformedVolume, WhatIsGivenIsNoFile) {
  const TemporaryFolder folder;
  for (const std::vector<path>& paths : std::vector<std::vector<path>>{
           {folder / "none.mha"},
           {folder / "none.dcm"},
           {folder.Write("a.mha", Meta("4 3 2") + kVoxels), folder.Write("b.mha", Meta("4 3 2") + kVoxels)},
           {folder.Write("a.dcm", DicomBytes({})), folder / "a.mha"}}) {
    Problems problems;
    EXPECT_FALSE(ReadVolumeFiles(paths, {}, problems));
    EXPECT_FALSE(problems.empty());
  }
}

// Any byte of a header replaced: an image or problems, and no crash.
TEST(MalformedVolume, AnyByteChanged) {
  std::mt19937 random(1);
  std::size_t refused = 0;
  for (const auto& [name, bytes] : std::vector<std::pair<std::string, std::string>>{
           {"a.mha",
            Meta("4 3 2", "ElementSpacing = 1 2 3\nOffset = 1 2 3\nTransformMatrix = 1 0 0 0 1 0 0 0 1\n") + kVoxels},
           {"a.nrrd",
            Nrrd("4 3 2", "encoding: raw\nspace: left-posterior-superior\nspace origin: (1,2,3)\n") + kVoxels},
           {"a.nii", NiftiBytes({4, 3, 2}, kVoxels, false)},
           {"a.dcm", DicomBytes({})}}) {
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(random());
      Problems problems;
      const std::optional<VolumeImage> image = ReadVolume({{name, changed}}, {}, problems);
      ASSERT_EQ(image.has_value(), problems.empty()) << name << " " << at;
      refused += image ? 0 : 1;
    }
  }
  EXPECT_GT(refused, 100u);
}

}  // namespace
}  // namespace fascicle::testing
