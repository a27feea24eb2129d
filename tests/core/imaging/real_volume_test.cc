// Scans of people: sizes, spacings and positions as other programs report them.
#include <gtest/gtest.h>

#include <cmath>

#include "core/imaging/image_stage.h"
#include "core/imaging/volume_reader.h"
#include "tests/support/paths.h"

namespace fascicle::testing {
namespace {

std::optional<VolumeImage> ReadData(const std::string& name) {
  Problems problems;
  std::optional<VolumeImage> image = ReadVolumeFiles({DataFolder() / name}, {}, problems);
  EXPECT_TRUE(image) << name << ": " << problems.ToString();
  if (image) {
    EXPECT_EQ(image->values.size(), image->voxels());
  }
  return image;
}

bool Missing(const std::string& name) { return !std::filesystem::exists(DataFolder() / name); }

#define SKIP_WITHOUT(name) \
  if (Missing(name)) GTEST_SKIP() << name << " is not there; set FASCICLE_DATA"

TEST(RealVolume, LabelsOfAnUpperArm) {
  const std::string name = "voxel_labels/upper_arm_biceps1_triceps2_1mm.mha";
  SKIP_WITHOUT(name);
  const auto image = ReadData(name);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->size, (GridIndex{129, 136, 349}));
  EXPECT_LT((image->origin - 1e-3 * Vec3(5.90222, 71.3792, -636.5)).norm(), 1e-9);
  ImageStage stage;
  stage.choice = LabelChoice{{1, 2}};
  stage.cleaning.keep = KeptParts::kAll;
  ThreadTeam team(1);
  Problems problems;
  const auto staged = RunImageStage(*image, stage, team, problems);
  ASSERT_TRUE(staged) << problems.ToString();
  EXPECT_GT(staged->statistics[0].voxels, 100000);
  EXPECT_GT(staged->statistics[1].voxels, 100000);
}

// Numbers of the header at the byte offsets that NIfTI-1 defines.
TEST(RealVolume, ThighsByTheirHeader) {
  const std::string name = "qmritools_leg_mri/test_up.nii.gz";
  SKIP_WITHOUT(name);
  const auto image = ReadData(name);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->size, (GridIndex{320, 320, 31}));
  EXPECT_LT((image->spacing - Vec3(1.5e-3, 1.5e-3, 6e-3)).norm(), 1e-6);
  EXPECT_LT((image->direction.cwiseAbs2() - Mat3::Identity()).norm(), 0.2) << "axial slices";
}

TEST(RealVolume, OneThigh) {
  const std::string name = "qmritools_leg_mri/thigh_one_leg_i16.mha";
  SKIP_WITHOUT(name);
  const auto image = ReadData(name);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->size, (GridIndex{124, 117, 31}));
  EXPECT_LT((image->spacing - Vec3(1.5e-3, 1.5e-3, 6e-3)).norm(), 1e-6);
}

TEST(RealVolume, ComputedTomography) {
  for (const char* file : {"example_ct.nii.gz", "example_ct_sm.nii.gz", "example_mr_sm.nii.gz", "example_seg.nii.gz"}) {
    const std::string name = std::string("totalsegmentator_ct/") + file;
    SKIP_WITHOUT(name);
    const auto image = ReadData(name);
    ASSERT_TRUE(image);
    EXPECT_GT(image->voxels(), 10000u);
  }
  // A scan and its labels have the same position.
  const auto scan = ReadData("totalsegmentator_ct/example_ct.nii.gz");
  const float darkest = *std::min_element(scan->values.begin(), scan->values.end());
  EXPECT_LE(darkest, -900) << "air, in Hounsfield's units";
}

TEST(RealVolume, Head) {
  const std::string name = "vtk_headsq/headsq.mha";
  SKIP_WITHOUT(name);
  const auto image = ReadData(name);
  ASSERT_TRUE(image);
  EXPECT_GT(image->voxels(), 100000u);
}

TEST(RealVolume, TheSameSliceInFourTransferSyntaxes) {
  SKIP_WITHOUT("dicom_small/MR_small.dcm");
  const auto slice = ReadData("dicom_small/MR_small.dcm");
  ASSERT_TRUE(slice);
  EXPECT_EQ(slice->size, (GridIndex{64, 64, 1}));
  for (const char* other : {"MR_small_bigendian.dcm", "MR_small_RLE.dcm", "MR_small_implicit.dcm"}) {
    const auto same = ReadData(std::string("dicom_small/") + other);
    ASSERT_TRUE(same);
    EXPECT_EQ(same->values, slice->values) << other;
    EXPECT_LT((same->origin - slice->origin).norm(), 1e-9);
    EXPECT_LT((same->direction - slice->direction).norm(), 1e-9);
    EXPECT_EQ(same->spacing, slice->spacing);
  }
  const auto tomography = ReadData("dicom_small/CT_small.dcm");
  ASSERT_TRUE(tomography);
  EXPECT_EQ(tomography->size, (GridIndex{128, 128, 1}));
  EXPECT_LE(*std::min_element(tomography->values.begin(), tomography->values.end()), -800) << "rescaled: air";
}

}  // namespace
}  // namespace fascicle::testing
