// Real anatomy and other public meshes; their sources are in the README of the data.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "core/geometry/mesh_checks.h"
#include "core/geometry/mesh_io.h"
#include "core/geometry/region.h"
#include "tests/support/files.h"
#include "tests/support/mesh_samples.h"
#include "tests/support/paths.h"

namespace fascicle {
namespace {

struct RealMesh {
  std::string file;
  double unit;  // [m]
  std::size_t nodes, tetrahedra, tagged_triangles;
  double volume;        // [cm^3], as printed with four digits
  std::string problem;  // its defect, if any
};

class RealMeshes : public ::testing::TestWithParam<RealMesh> {};

TEST_P(RealMeshes, AreReadAndChecked) {
  const RealMesh& expected = GetParam();
  const std::filesystem::path path = testing::DataFolder() / expected.file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there; set FASCICLE_DATA";
  const std::string elements =
      path.extension() == ".node" ? testing::ReadFile(std::filesystem::path(path).replace_extension(".ele")) : "";
  Problems problems;
  std::optional<TetMesh> mesh = ReadMesh({expected.file, testing::ReadFile(path), elements}, problems);
  ASSERT_TRUE(mesh) << problems.ToString();
  EXPECT_EQ(mesh->nodes.size(), expected.nodes);
  EXPECT_EQ(mesh->tetrahedra.size(), expected.tetrahedra);
  EXPECT_EQ(mesh->tagged_triangles.size(), expected.tagged_triangles);
  for (Vec3& node : mesh->nodes) node *= expected.unit;
  OrientConsistently(*mesh);
  const MeshReport report = CheckMesh(*mesh, problems);
  EXPECT_EQ(report.components, 1);
  EXPECT_NEAR(report.volume * 1e6 / expected.volume, 1, 5e-4) << report.volume * 1e6;
  if (expected.problem.empty()) {
    EXPECT_TRUE(problems.empty()) << problems.ToString();
  } else {
    EXPECT_EQ(problems.count(), 1u);
    EXPECT_THAT(problems.ToString(), ::testing::HasSubstr(expected.problem));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Files, RealMeshes,
    ::testing::Values(
        RealMesh{"opendihu_upper_arm/biceps_coarse.msh", 1e-3, 1677, 6673, 0, 308.9, ""},
        RealMesh{"opendihu_upper_arm/biceps_medium.msh", 1e-3, 7079, 32578, 0, 317.2, ""},
        RealMesh{"opendihu_upper_arm/triceps_coarse.msh", 1e-3, 2053, 8358, 0, 612.0, ""},
        RealMesh{"opendihu_upper_arm/triceps_medium.msh", 1e-3, 6770, 30719, 0, 627.9, ""},
        RealMesh{"vh_muscle_tets/VHF_Left_Muscle_TibialisAnterior.msh", 1e-3, 2490, 8346, 3792, 81.78, ""},
        RealMesh{"vh_muscle_tets/VHM_Left_Muscle_BicepsFemorisLongus.msh", 1e-3, 2482, 8865, 3476, 313.1, ""},
        RealMesh{"vh_muscle_tets/VHM_Left_Muscle_TibialisAnterior.msh", 1e-3, 2450, 8287, 3644, 187.5, ""},
        RealMesh{"odedstein_meshes/penguin/penguin_coarse.msh", 1e-3, 532, 1876, 0, 1759, ""},
        RealMesh{"odedstein_meshes/penguin/penguin_medium.msh", 1e-3, 1960, 7846, 0, 1914, ""},
        RealMesh{"stanford/bunny/bunny_polyfem_19k_tets.msh", 1e-1, 4670, 19379, 0, 6010, ""},
        RealMesh{"polyfem_tets/bar-186.msh", 1e-2, 86, 186, 0, 5, ""},
        RealMesh{"polyfem_tets/bar-651.msh", 1e-2, 292, 651, 0, 5, ""},
        RealMesh{"polyfem_tets/bar-2523.msh", 1e-2, 886, 2523, 0, 5, ""},
        RealMesh{"polyfem_tets/torus.msh", 1e-1, 200, 491, 0, 72.65, ""},
        // Sets of four nodes near a common circle, which Delaunay's criterion leaves as slivers without volume.
        RealMesh{"artisynth/muscle.1.node", 1e-2, 65, 150, 0, 78.04, "tetrahedra are degenerate (flat)"},
        RealMesh{"artisynth/sphere2.1.node", 1e-2, 54, 174, 0, 3.659, ""},
        RealMesh{"artisynth/torus546.1.node", 1e-2, 297, 770, 0, 0.3554, ""}),
    [](const auto& test) {
      std::string name = std::filesystem::path(test.param.file).stem().string();
      for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
      return name;
    });

// The attachments of a muscle are two patches at its ends.
TEST(RealMeshTest, AttachmentsAreTagged) {
  const std::filesystem::path path = testing::DataFolder() / "vh_muscle_tets/VHM_Left_Muscle_BicepsFemorisLongus.msh";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there; set FASCICLE_DATA";
  Problems problems;
  const std::optional<TetMesh> mesh = ReadMesh({path.string(), testing::ReadFile(path), ""}, problems);
  ASSERT_TRUE(mesh) << problems.ToString();
  EXPECT_THAT(mesh->tetrahedron_tags, ::testing::Each(10));
  const std::vector<Triangle> surface = BoundaryTriangles(*mesh);
  std::size_t triangles = 0;
  for (const std::int32_t tag : {1, 2, 3}) {
    const Region region = SelectRegion(*mesh, surface, "attachment", TagSelector{tag});
    EXPECT_GT(region.nodes.size(), 10u);
    triangles += region.triangles.size();
  }
  EXPECT_EQ(triangles, surface.size()) << "the three tags cover the surface";
  EXPECT_EQ(SelectRegion(*mesh, surface, "all", TagSelector{10}).triangles.size(), surface.size());
}

}  // namespace
}  // namespace fascicle
