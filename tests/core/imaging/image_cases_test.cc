// Images that people have (FASCICLE_CASES): each is read at its right place, size and value, or refused with the cause.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "core/imaging/labels.h"
#include "core/imaging/volume_reader.h"
#include "tests/support/paths.h"

namespace fascicle::testing {
namespace {

using ::testing::HasSubstr;

constexpr const char* kImageFolders[] = {"nifti_place", "nifti_values", "nifti_units", "metaimage", "nrrd", "dicom"};

#define SKIP_WITHOUT_CASES()                             \
  if (!std::filesystem::exists(CasesFolder() / "dicom")) \
  GTEST_SKIP() << CasesFolder() << " is not there; set FASCICLE_CASES"

// Volume [mm^3] and centre [mm] of the voxels for which `in_body` holds.
struct BodyInImage {
  double volume = 0;
  Vec3 centre = Vec3::Zero();
};
template <class InBody>
BodyInImage Measure(const VolumeImage& image, const InBody& in_body) {
  std::size_t voxels = 0;
  BodyInImage body;
  for (std::int32_t k = 0; k < image.size[2]; ++k) {
    for (std::int32_t j = 0; j < image.size[1]; ++j) {
      for (std::int32_t i = 0; i < image.size[0]; ++i) {
        if (!in_body(image.values[image.IndexOf({i, j, k})])) continue;
        ++voxels;
        body.centre += 1e3 * image.CentreOf({i, j, k});
      }
    }
  }
  body.volume = static_cast<double>(voxels) * image.voxel_volume() * 1e9;
  body.centre /= static_cast<double>(std::max<std::size_t>(voxels, 1));
  return body;
}

// Largest error of a centre [mm]: what rounding in the file itself leaves.
double ToleranceOf(const std::string& name) {
  static const std::map<std::string, double> tolerances = {
      {"nifti_place/far.nii", 0.02},            // floats at 300 m
      {"nifti_place/sheared_0.001.nii", 0.01},  // axes put at right angles around the image's centre
      {"nifti_place/sheared_0.01.nii", 0.05},
      {"dicom/jitter_0.01mm", 0.02},
      {"dicom/rounded_positions", 0.1}};
  const auto found = tolerances.find(name);
  return found == tolerances.end() ? 1e-3 : found->second;
}

TEST(ImageCases, HaveTheirVolumeCentreAndLabel) {
  SKIP_WITHOUT_CASES();
  int compared = 0, absent = 0;
  for (const std::string folder : kImageFolders) {
    std::ifstream in(CasesFolder() / folder / "expected.json");
    const auto expected = nlohmann::json::parse(in);
    for (const auto& [file, right] : expected.items()) {
      const std::string name = folder + "/" + file;
      if (!right.contains("volume")) continue;
      if (!std::filesystem::exists(CasesFolder() / name)) {
        ++absent;
        continue;
      }
      Problems problems;
      const auto image = ReadVolumeFiles({CasesFolder() / name}, {}, problems);
      EXPECT_TRUE(image) << name << ": " << problems.ToString();
      if (!image) continue;
      // Numbers of a slice that are multiples of its own slope do not hit 100.
      const bool rounded = name == "dicom/per_slice_slope";
      const int label = right.contains("mask") ? 1 : right["label"].get<int>();
      const BodyInImage body = Measure(*image, [&](float value) {
        return rounded ? std::abs(value - static_cast<float>(label)) < 0.5F : HasLabel(value, label);
      });
      EXPECT_NEAR(body.volume / right["volume"].get<double>(), 1, 1e-4) << name;
      ++compared;
      double error = 0;
      if (right.contains("lps")) {
        const auto lps = right["lps"].get<std::vector<double>>();
        error = (body.centre - Vec3(lps[0], lps[1], lps[2])).norm();
        EXPECT_LT(error, ToleranceOf(name)) << name << ": " << body.centre.transpose();
      }
      std::printf("%-40s %9.4f mm^3 at (%10.3f, %10.3f, %10.3f), off by %.1e mm\n", name.c_str(), body.volume,
                  body.centre[0], body.centre[1], body.centre[2], error);
      for (const std::string& note : image->notes) std::printf("%40s note  %s\n", "", note.c_str());
    }
  }
  std::printf("%d compared, %d are not there\n", compared, absent);
  EXPECT_GT(compared, 60);
}

// What is refused, with a part of the cause.
TEST(ImageCases, AreRefusedWithTheCause) {
  SKIP_WITHOUT_CASES();
  for (const auto& [name, cause] : std::map<std::string, std::string>{
           {"truncated/cut.mha", "incomplete or damaged"},
           {"truncated/cut.nii", "the file is too short"},
           {"truncated/cut.nii.gz", "incomplete or damaged"},
           {"truncated/raw_cut.mha", "the file is too short"},
           {"nifti_place/zero_pixdim.nii", "no volume: their spacing is 0 x 0 x 0"},
           {"nifti_values/rgb.nii", "3 components"},
           {"nifti_values/four_d.nii", "3 volumes along its dimension 4"},
           {"metaimage/channels.mha", "3 components"},
           {"metaimage/ndims4_3.mha", "3 volumes along its dimension 4"},
           {"nrrd/spacings_only_some.nrrd", "their spacing is 0.5 x 0.75 x nan"},
           {"nrrd/layers.seg.nrrd", "2 components"},
           {"dicom/missing_slice", "slices are missing"},
           {"dicom/scout_in_series", "scout.dcm has a different direction"},
           {"dicom/two_series", "2 series"},
           {"dicom/two_times", "at the same position"},
           {"dicom/no_positions", "s001.dcm and 15 more do not state ImagePositionPatient (0020,0032)"},
           {"dicom/multiframe_sc_bare/multi.dcm", "SpacingBetweenSlices (0018,0088)"},
           {"dicom/rgb/rgb.dcm", "3 components"}}) {
    Problems problems;
    EXPECT_FALSE(ReadVolumeFiles({CasesFolder() / name}, {}, problems)) << name;
    EXPECT_THAT(problems.ToString(), HasSubstr(cause)) << name;
  }
}

// What is read with a decision, which a note tells.
TEST(ImageCases, NoteWhatWasDecided) {
  SKIP_WITHOUT_CASES();
  struct Case {
    const char *name, *note;
    double volume;  // of label 1, or 100 in DICOM [mm^3]
  };
  for (const Case& one :
       std::vector<Case>{{"nifti_place/forms_disagree_scanner_vs_aligned.nii", "mm: the qform is taken", 630},
                         {"nifti_place/sform_without_spacing.nii", "mm: the sform is taken", 840},
                         {"nifti_place/sheared_0.001.nii", "not quite at right angles", 630},
                         {"nifti_place/sheared_0.01.nii", "not quite at right angles", 630},
                         {"nifti_units/unknown.nii", "does not say the unit of lengths: millimetres", 630},
                         {"metaimage/no_spacing.mha", "no ElementSpacing: voxels of 1 mm", 840},
                         {"nrrd/scanner_xyz.nrrd", "its space is scanner-xyz", 630},
                         {"nrrd/space_dimension.nrrd", "the header names no space", 630},
                         {"dicom/one_slice/one.dcm", "taken as thick as it states, 2.5 mm", 112.5}}) {
    Problems problems;
    const auto image = ReadVolumeFiles({CasesFolder() / one.name}, {}, problems);
    ASSERT_TRUE(image) << one.name << ": " << problems.ToString();
    EXPECT_THAT(image->notes, ::testing::Contains(HasSubstr(one.note))) << one.name;
    const int label = std::string(one.name).starts_with("dicom") ? 100 : 1;
    EXPECT_NEAR(Measure(*image, [&](float value) { return HasLabel(value, label); }).volume, one.volume,
                1e-4 * one.volume)
        << one.name;
  }
  Problems problems;
  const auto nan = ReadVolumeFiles({CasesFolder() / "nifti_values/nan_background.nii"}, {}, problems);
  ASSERT_TRUE(nan) << problems.ToString();
  EXPECT_THAT(nan->notes, ::testing::Contains(HasSubstr("1 voxels are infinite or not numbers: they are read as 0")));
  const auto qform =
      ReadVolumeFiles({CasesFolder() / "nifti_place/forms_disagree_scanner_vs_aligned.nii"}, {}, problems);
  ASSERT_TRUE(qform);
  const Vec3 centre = Measure(*qform, [](float value) { return HasLabel(value, 1); }).centre;
  EXPECT_LT((centre - Vec3(85.964, 120.643, -61.821)).norm(), 1e-3) << "of the scanner";
}

// The same voxels whether the header has the size of the compressed data or not.
TEST(ImageCases, CompressedDataAreReadToTheirEnd) {
  SKIP_WITHOUT_CASES();
  Problems problems;
  const auto with = ReadVolumeFiles({CasesFolder() / "metaimage/scan_size.mha"}, {}, problems);
  const auto without = ReadVolumeFiles({CasesFolder() / "metaimage/scan_no_size.mha"}, {}, problems);
  ASSERT_TRUE(with && without) << problems.ToString();
  EXPECT_EQ(with->values, without->values);
  EXPECT_GT(*std::max_element(with->values.begin(), with->values.end()), 0);
}

}  // namespace
}  // namespace fascicle::testing
