// Muscles and bones of the Visible Human's left leg: 4,000 triangles each, mm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <ctime>
#include <filesystem>
#include <numbers>

#include "core/geometry/mesh_checks.h"
#include "core/geometry/tetrahedralize.h"
#include "surface_samples.h"
#include "tests/support/files.h"
#include "tests/support/paths.h"

namespace fascicle {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr double kDegreeOfSurfaces = std::numbers::pi / 180;

fs::path LegFolder() { return testing::DataFolder() / "vh_muscle_surfaces"; }

TriangleMesh ReadLeg(const std::string& name) {
  const fs::path path = LegFolder() / ("VHM_Left_" + name + "_4k.stl");
  Problems problems;
  auto surface = ReadSurface(path.string(), testing::ReadFile(path), problems);
  EXPECT_TRUE(surface) << problems.ToString();
  return surface ? std::move(*surface) : CornerSurface();
}

std::optional<MeshingResult> Mesh(TriangleMesh surface, std::int64_t tetrahedra, Problems& problems) {
  ThreadTeam team(1);
  MeshingOptions options;
  options.tetrahedra = tetrahedra;
  return Tetrahedralize(surface, options, team, problems);
}

// Requirements on a mesh: positive volumes, connected, no angle below 10 degrees, at most 0.5 % volume error.
void ExpectGood(const MeshingResult& result) {
  TetMesh mesh = result.mesh;
  for (Vec3& node : mesh.nodes) node *= 1e-3;
  Problems problems;
  const MeshReport report = CheckMesh(mesh, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  EXPECT_EQ(report.components, 1);
  EXPECT_GE(report.smallest_dihedral_angle, 10 * kDegreeOfSurfaces);
  EXPECT_NEAR(result.report.VolumeError(), 0, 5e-3);
}

#define SKIP_WITHOUT_DATA() \
  if (!fs::exists(LegFolder())) GTEST_SKIP() << LegFolder() << " is not there; set FASCICLE_DATA"

TEST(RealSurfaceTest, EveryMuscleAndBoneOfTheLeg) {
  SKIP_WITHOUT_DATA();
  int muscles = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(LegFolder())) {
    if (entry.path().extension() != ".stl") continue;
    SCOPED_TRACE(entry.path().filename());
    muscles += entry.path().string().find("Muscle") != std::string::npos ? 1 : 0;
    Problems problems;
    const auto surface = ReadSurface(entry.path().string(), testing::ReadFile(entry.path()), problems);
    ASSERT_TRUE(surface) << problems.ToString();
    const auto result = Mesh(*surface, 4000, problems);
    ASSERT_TRUE(result) << problems.ToString();
    ExpectGood(*result);
  }
  EXPECT_EQ(muscles, 18);
}

TEST(RealSurfaceTest, FiftyThousandTetrahedraInHalfAMinute) {
  SKIP_WITHOUT_DATA();
  const TriangleMesh surface = ReadLeg("Muscle_BicepsFemorisLongus");
  const std::clock_t start = std::clock();
  Problems problems;
  const auto result = Mesh(surface, 50000, problems);
  [[maybe_unused]] const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;  // of all threads
  ASSERT_TRUE(result) << problems.ToString();
  ExpectGood(*result);
  EXPECT_NEAR(static_cast<double>(result->mesh.tetrahedra.size()), 50000, 2500);
  EXPECT_NEAR(result->report.VolumeError(), 0, 1e-4);
  EXPECT_LT(result->report.surface_distance, 0.5 * result->report.size);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_LT(seconds, 30);
#endif
}

TEST(RealSurfaceTest, AHoleIsClosedOrRefused) {
  SKIP_WITHOUT_DATA();
  const TriangleMesh whole = ReadLeg("Muscle_RectusFemoris");
  const Vec3 point = whole.nodes[1000];
  Problems problems;
  const auto result = Mesh(WithHole(whole, point, 5), 4000, problems);
  ASSERT_TRUE(result) << problems.ToString();
  ExpectGood(*result);
  ASSERT_EQ(result->report.surface.holes.size(), 1u);
  EXPECT_LT((result->report.surface.holes[0].centre - point).norm(), 5);
  EXPECT_NEAR(result->report.volume / EnclosedVolume(whole), 1, 5e-3);

  EXPECT_FALSE(Mesh(WithHole(whole, point, 60), 4000, problems));
  EXPECT_THAT(problems.ToString(), HasSubstr("the surface has a hole at ("));
}

TEST(RealSurfaceTest, ASurfaceThatCutsItselfIsRepairedOrRefused) {
  SKIP_WITHOUT_DATA();
  const TriangleMesh whole = ReadLeg("Muscle_RectusFemoris");
  // One node is pulled through the opposite side, as by a slip of the hand in a segmentation.
  TriangleMesh spiked = whole;
  double height = 0;
  for (const Vec3& x : whole.nodes) height += x.z() / static_cast<double>(whole.nodes.size());
  const auto node =
      static_cast<std::int32_t>(std::min_element(whole.nodes.begin(), whole.nodes.end(),
                                                 [&](const Vec3& a, const Vec3& b) {
                                                   return std::abs(a.z() - height) < std::abs(b.z() - height);
                                                 }) -
                                whole.nodes.begin());
  Vec3 outward = Vec3::Zero();
  for (const Triangle& t : whole.triangles) {
    if (std::find(t.begin(), t.end(), node) == t.end()) continue;
    outward += (whole.nodes[t[1]] - whole.nodes[t[0]]).cross(whole.nodes[t[2]] - whole.nodes[t[0]]);
  }
  spiked.nodes[node] -= 60 * outward.normalized();
  Problems problems;
  const auto result = Mesh(spiked, 4000, problems);
  ASSERT_TRUE(result) << problems.ToString();
  ExpectGood(*result);
  EXPECT_FALSE(result->report.surface.cuts.empty());

  // Two neighbouring muscles that overlap.
  EXPECT_FALSE(Mesh(Joined(whole, Moved(whole, {8, 1, 2})), 4000, problems));
  EXPECT_THAT(problems.ToString(), HasSubstr("the surface intersects itself at ("));
}

}  // namespace
}  // namespace fascicle
