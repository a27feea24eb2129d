// DICOM slices stacked to volumes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/imaging/volume_reader.h"
#include "tests/support/files.h"
#include "tests/support/volume_files.h"

namespace fascicle::testing {
namespace {

using std::filesystem::path;
using ::testing::HasSubstr;

// Sagittal slices 2.5 mm apart along -x, the normal of rows along y and columns along -z; in arbitrary order.
std::vector<DicomSlice> Sagittal(int count) {
  std::vector<DicomSlice> slices;
  for (int n = 0; n < count; ++n) {
    const int s = (n * 2) % count;  // an odd count: all of them once
    DicomSlice slice;
    slice.orientation = "0\\1\\0\\0\\0\\-1";
    slice.position = std::to_string(40 - 2.5 * s) + "\\-7\\90";
    slice.first_value = 100 * s;
    slices.push_back(slice);
  }
  return slices;
}

std::vector<path> WriteAll(const TemporaryFolder& folder, const std::vector<DicomSlice>& slices) {
  std::vector<path> paths;
  for (std::size_t s = 0; s < slices.size(); ++s) {
    paths.push_back(folder.Write("slice" + std::to_string(s) + ".dcm", DicomBytes(slices[s])));
  }
  return paths;
}

std::string Refusal(const std::vector<DicomSlice>& slices) {
  const TemporaryFolder folder;
  Problems problems;
  EXPECT_FALSE(ReadVolumeFiles(WriteAll(folder, slices), {}, problems));
  EXPECT_FALSE(problems.empty());
  return problems.ToString();
}

void ExpectSagittal(const std::optional<VolumeImage>& image, const Problems& problems) {
  ASSERT_TRUE(image) << problems.ToString();
  EXPECT_EQ(image->size, (GridIndex{4, 3, 5}));
  EXPECT_LT((image->spacing - Vec3(0.75e-3, 1.5e-3, 2.5e-3)).norm(), 1e-9);
  for (std::int32_t k = 0; k < 5; ++k) {
    for (std::int32_t j = 0; j < 3; ++j) {
      for (std::int32_t i = 0; i < 4; ++i) {
        const Vec3 expected = 1e-3 * Vec3(40 - 2.5 * k, -7 + 0.75 * i, 90 - 1.5 * j);
        ASSERT_LT((image->CentreOf({i, j, k}) - expected).norm(), 1e-9);
        ASSERT_EQ(image->values[image->IndexOf({i, j, k})], static_cast<float>(100 * k + 4 * j + i));
      }
    }
  }
}

TEST(Dicom, StacksSlicesAlongTheirNormal) {
  const TemporaryFolder folder;
  const std::vector<path> paths = WriteAll(folder, Sagittal(5));
  Problems problems;
  ExpectSagittal(ReadVolumeFiles(paths, {}, problems), problems);
  // The folder, with an unrelated file in it.
  folder.Write("notes.txt", "head first");
  ExpectSagittal(ReadVolumeFiles({folder.path()}, {}, problems), problems);
}

TEST(Dicom, SlicesOfDifferentFoldersMayHaveTheSameName) {
  std::vector<std::string> bytes;
  for (const DicomSlice& slice : Sagittal(5)) bytes.push_back(DicomBytes(slice));
  std::vector<VolumeFile> files;
  for (const std::string& one : bytes) files.push_back({"somewhere/IM0001", one});
  Problems problems;
  ExpectSagittal(ReadVolume(files, {}, problems), problems);
}

TEST(Dicom, HeedsStopRequests) {
  const TemporaryFolder folder;
  const std::vector<path> paths = WriteAll(folder, Sagittal(5));
  std::stop_source source;
  source.request_stop();
  VolumeReaderOptions options;
  options.stop = source.get_token();
  Problems problems;
  EXPECT_THROW(ReadVolumeFiles(paths, options, problems), Stopped);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
}

TEST(Dicom, RescalesEachSliceByItself) {
  std::vector<DicomSlice> slices = Sagittal(3);
  slices[1].slope = "2";
  slices[1].intercept = "-50";
  const TemporaryFolder folder;
  Problems problems;
  const std::optional<VolumeImage> image = ReadVolumeFiles(WriteAll(folder, slices), {}, problems);
  ASSERT_TRUE(image) << problems.ToString();
  EXPECT_EQ(image->values[image->IndexOf({1, 0, 2})], 2 * 201 - 50);
  EXPECT_EQ(image->values[image->IndexOf({1, 0, 1})], 101);
}

TEST(Dicom, ASliceAloneIsAVolumeOfOneLayer) {
  const TemporaryFolder folder;
  Problems problems;
  const std::optional<VolumeImage> image = ReadVolumeFiles(WriteAll(folder, Sagittal(1)), {}, problems);
  ASSERT_TRUE(image) << problems.ToString();
  EXPECT_EQ(image->size, (GridIndex{4, 3, 1}));
  EXPECT_EQ(image->values[7], 7);
  EXPECT_DOUBLE_EQ(image->spacing[2], 2.5e-3) << "its SliceThickness";
  std::vector<DicomSlice> bare = Sagittal(1);
  bare[0].thickness.clear();
  EXPECT_THAT(Refusal(bare), HasSubstr("does not state its SliceThickness"));
}

TEST(Dicom, TellsWhichSizesAndPlacesAreNotStated) {
  std::vector<DicomSlice> slices = Sagittal(3);
  for (DicomSlice& slice : slices) slice.position.clear();
  slices[1].spacing.clear();
  EXPECT_THAT(Refusal(slices), AllOf(HasSubstr("slice0.dcm and 2 more do not state ImagePositionPatient (0020,0032)"),
                                     HasSubstr("slice1.dcm does not state PixelSpacing (0028,0030)")));
}

// Old files start without a preamble, and a folder may hold the folder of the series.
TEST(Dicom, FilesWithoutPreambleInFoldersOfTheFolder) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "study/series");
  std::size_t s = 0;
  for (const DicomSlice& slice : Sagittal(5)) {
    folder.Write("study/series/IM" + std::to_string(s++), DicomBytes(slice).substr(132));
  }
  Problems problems;
  ExpectSagittal(ReadVolumeFiles({folder.path()}, {}, problems), problems);
}

TEST(Dicom, RefusesWhatIsNoSeries) {
  std::vector<DicomSlice> slices = Sagittal(5);
  slices[2].series = "1.2.3.5";
  EXPECT_THAT(Refusal(slices), HasSubstr("belong to 2 series"));
  slices = Sagittal(5);
  slices[2].rows = 4;
  EXPECT_THAT(Refusal(slices), HasSubstr("slice2.dcm has a different size than slice0.dcm"));
  slices = Sagittal(5);
  slices[3].spacing = "1.5\\0.8";
  EXPECT_THAT(Refusal(slices), HasSubstr("slice3.dcm has a different spacing"));
  slices = Sagittal(5);
  slices[1].orientation = "0\\1\\0\\0\\0\\1";
  EXPECT_THAT(Refusal(slices), HasSubstr("slice1.dcm has a different direction"));
  slices = Sagittal(5);
  slices[1].position = slices[0].position;
  EXPECT_THAT(Refusal(slices), HasSubstr("at the same position"));
  slices = Sagittal(7);
  slices.erase(slices.begin() + 2);
  EXPECT_THAT(Refusal(slices), HasSubstr("slices are missing"));
  slices = Sagittal(5);
  for (std::size_t s = 0; s < slices.size(); ++s) {
    const int height = slices[s].first_value / 100;
    slices[s].position = std::to_string(40 - 2.5 * height) + "\\" + std::to_string(-7 + height) + "\\90";
  }
  EXPECT_THAT(Refusal(slices), HasSubstr("shifted relative to each other"));
}

TEST(Dicom, TellsAllBrokenSlicesAtOnce) {
  const TemporaryFolder folder;
  std::vector<path> paths = WriteAll(folder, Sagittal(5));
  folder.Write("slice1.dcm", DicomBytes(Sagittal(5)[1]).substr(0, 300));
  folder.Write("slice3.dcm", "no DICOM at all");
  paths.push_back(folder / "slice9.dcm");
  Problems problems;
  EXPECT_FALSE(ReadVolumeFiles(paths, {}, problems));
  EXPECT_THAT(problems.ToString(), HasSubstr("slice9.dcm"));
  paths.pop_back();
  Problems broken;
  EXPECT_FALSE(ReadVolumeFiles(paths, {}, broken));
  EXPECT_EQ(broken.count(), 2u);
  EXPECT_THAT(broken.ToString(), HasSubstr("slice1.dcm: "));
  EXPECT_THAT(broken.ToString(), HasSubstr("slice3.dcm: "));
}

TEST(Dicom, AFolderWithoutSlicesIsToldApart) {
  const TemporaryFolder folder;
  Problems problems;
  EXPECT_FALSE(ReadVolumeFiles({folder.path()}, {}, problems));
  EXPECT_THAT(problems.ToString(), HasSubstr("no DICOM file is in the folder"));
}

}  // namespace
}  // namespace fascicle::testing
