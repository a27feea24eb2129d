// `fascicle mesh IMAGE` reads what the library reads: the images that people have (FASCICLE_CASES) at their right
// place, or the same refusals; and `voxelize` agrees.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/geometry/mesh_io.h"
#include "fascicle_fixture.h"

namespace fascicle::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

class ImageCasesTest : public FascicleTest {
 protected:
  void SetUp() override {
    if (!fs::exists(CasesFolder() / "dicom")) GTEST_SKIP() << CasesFolder() << " is not there; set FASCICLE_CASES";
  }
  Finished Mesh(const std::string& name, int label) {
    return Fascicle({"mesh", CasesFolder() / name, "--label", std::to_string(label), "--smooth", "0.3", "--tets",
                     "2000", "--json", "--out", folder_ / "body.msh"});
  }
  // The centre of the mesh that was written [mm].
  Vec3 Centre() const {
    const std::string bytes = ReadFile(folder_ / "body.msh");
    Problems problems;
    const auto mesh = ReadMesh({"body.msh", bytes, {}}, problems);
    EXPECT_TRUE(mesh) << problems.ToString();
    Vec3 centre = Vec3::Zero();
    for (std::size_t t = 0; mesh && t < mesh->tetrahedra.size(); ++t) {
      centre += SignedVolume(*mesh, t) * Centroid(*mesh, t);
    }
    return mesh ? Vec3(centre / TotalVolume(*mesh)) : centre;
  }
};

TEST_F(ImageCasesTest, AreMeshedAtTheirPlaceAndSize) {
  int compared = 0, files = 0;
  for (const std::string folder : {"nifti_place", "nifti_values", "nifti_units", "metaimage", "nrrd", "dicom"}) {
    std::ifstream in(CasesFolder() / folder / "expected.json");
    const json expected = json::parse(in);
    for (const auto& [file, right] : expected.items()) {
      const std::string name = folder + "/" + file;
      // Values of that series do not hit their label.
      if (!right.contains("volume") || !fs::exists(CasesFolder() / name) || name == "dicom/per_slice_slope") continue;
      // imaging_test reads all of them; here every third goes the whole way to a mesh.
      if (++files % 3 != 0) continue;
      const Finished made = Mesh(name, right.contains("mask") ? 1 : right["label"].get<int>());
      ASSERT_EQ(made.exit_code, 0) << name << ": " << made.err << made.out;
      const json report = json::parse(made.out);
      const double volume = right["volume"];
      EXPECT_EQ(report["unit"], "mm") << name;
      EXPECT_NEAR(report["voxel_volume"].get<double>() / volume, 1, 1e-4) << name;
      EXPECT_NEAR(report["volume"].get<double>() / volume, 1, 0.01) << name;
      double off = 0;
      if (right.contains("lps")) {
        const auto lps = right["lps"].get<std::vector<double>>();
        off = (Centre() - Vec3(lps[0], lps[1], lps[2])).norm();
        // The surface is smooth, and its tetrahedra are coarse.
        EXPECT_LT(off, 0.05) << name;
      }
      std::printf("%-40s %8.3f mm^3 of %8.3f, centre off by %.3f mm\n", name.c_str(), report["volume"].get<double>(),
                  volume, off);
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
}

TEST_F(ImageCasesTest, AreRefusedWithTheCauseByMeshAndVoxelize) {
  for (const auto& [name, cause] : std::vector<std::pair<std::string, std::string>>{
           {"truncated/cut.mha", "incomplete or damaged"},
           {"truncated/cut.nii.gz", "incomplete or damaged"},
           {"truncated/raw_cut.mha", "the file is too short"},
           {"nifti_place/zero_pixdim.nii", "no volume"},
           {"nifti_values/four_d.nii", "3 volumes"},
           {"nifti_values/soft_mask.nii", "existing values: 0.7; they are no labels"},
           {"metaimage/ndims4_3.mha", "3 volumes"},
           {"nrrd/layers.seg.nrrd", "2 components"},
           {"dicom/missing_slice", "slices are missing"},
           {"dicom/multiframe_sc_bare/multi.dcm", "SpacingBetweenSlices"}}) {
    const Finished meshed = Mesh(name, 1);
    EXPECT_EQ(meshed.exit_code, 2) << name;
    EXPECT_THAT(meshed.out + meshed.err, HasSubstr(cause)) << name;
    EXPECT_FALSE(HasFile("body.msh")) << name;
    const Finished voxelized = Fascicle({"voxelize", CasesFolder() / name, "--label", "1"});
    EXPECT_EQ(voxelized.exit_code, 2) << name;
    EXPECT_THAT(voxelized.out + voxelized.err, HasSubstr(cause)) << name;
  }
}

TEST_F(ImageCasesTest, NotesAreTold) {
  const std::string image = CasesFolder() / "nifti_place/forms_disagree_scanner_vs_aligned.nii";
  const Finished meshed = Fascicle({"mesh", image, "--label", "1", "--tets", "2000", "--out", folder_ / "body.msh"});
  EXPECT_THAT(meshed.out, HasSubstr("note  the sform (code 2) and the qform (code 1) differ")) << meshed.err;
  EXPECT_THAT(Fascicle({"voxelize", image, "--label", "1"}).out, HasSubstr("the qform is taken"));
  EXPECT_THAT(Fascicle({"segment", image, "--label", "1"}).out, HasSubstr("the qform is taken"));
  const Finished as_json = Fascicle({"voxelize", image, "--label", "1", "--json"});
  EXPECT_THAT(json::parse(as_json.out)["notes"].at(0).get<std::string>(), HasSubstr("the qform is taken"));
  // In metres, by the command's unit.
  const Finished metres = Fascicle({"mesh", CasesFolder() / "nifti_units/metre.nii", "--label", "1", "--tets", "2000",
                                    "--unit", "m", "--json", "--out", folder_ / "metres.msh"});
  ASSERT_EQ(metres.exit_code, 0) << metres.err;
  EXPECT_NEAR(json::parse(metres.out)["voxel_volume"].get<double>(), 630e-9, 1e-12);
}

}  // namespace
}  // namespace fascicle::testing
