#include "core/geometry/tetrahedralize.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geometry/mesh_checks.h"
#include "surface_samples.h"

namespace fascicle {
namespace {

using ::testing::HasSubstr;

constexpr double kRadiansPerDegree = std::numbers::pi / 180;

MeshingResult Mesh(TriangleMesh surface, std::int64_t tetrahedra, double size = 0, int threads = 1) {
  ThreadTeam team(threads);
  Problems problems;
  MeshingOptions options;
  options.tetrahedra = tetrahedra;
  options.size = size;
  auto result = Tetrahedralize(surface, options, team, problems);
  EXPECT_TRUE(result) << problems.ToString();
  return result ? std::move(*result) : MeshingResult{};
}

std::string MeshingProblemsOf(TriangleMesh surface, double size = 0) {
  ThreadTeam team(1);
  Problems problems;
  MeshingOptions options;
  options.tetrahedra = 4000;
  options.size = size;
  EXPECT_FALSE(Tetrahedralize(surface, options, team, problems));
  return problems.ToString();
}

struct ClosedForm {
  std::string name;
  TriangleMesh (*surface)();
  double volume;
};

class ClosedForms : public ::testing::TestWithParam<ClosedForm> {};

TEST_P(ClosedForms, HaveTheirVolumeAndGoodAngles) {
  const ClosedForm& form = GetParam();
  const MeshingResult result = Mesh(form.surface(), 6000);
  const MeshingReport& report = result.report;
  // A lattice cannot have a number of tetrahedra between these two of a box.
  EXPECT_NEAR(static_cast<double>(result.mesh.tetrahedra.size()) / 6000, 1, form.name == "box" ? 0.1 : 0.05);
  EXPECT_GT(report.angles.smallest, 14 * kRadiansPerDegree);
  EXPECT_GT(report.angles.median, 40 * kRadiansPerDegree);
  EXPECT_LT(report.angles.largest, 165 * kRadiansPerDegree);
  // The surface's triangles themselves enclose 0.3 % less than the round shapes.
  EXPECT_NEAR(report.volume / form.volume, 1, 5e-3);
  EXPECT_NEAR(report.VolumeError(), 0, 1e-4);
  EXPECT_LT(report.surface_distance, 0.5 * report.size);
  Problems problems;
  CheckMesh(result.mesh, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
}

INSTANTIATE_TEST_SUITE_P(Shapes, ClosedForms,
                         ::testing::Values(ClosedForm{"sphere", [] { return SurfaceOf(MakeSphere(1, 24)); },
                                                      4 * std::numbers::pi / 3},
                                           ClosedForm{"torus",
                                                      [] {
                                                        return SurfaceOf(MakeTorus({1, 0.4, 96, 16}));
                                                      },
                                                      2 * std::numbers::pi* std::numbers::pi * 0.16},
                                           ClosedForm{"box",
                                                      [] {
                                                        return SurfaceOf(MakeBox({0, 0, 0}, {1, 0.6, 0.8}, {1, 1, 1}));
                                                      },
                                                      0.48}),
                         [](const auto& test) { return test.param.name; });

TEST(TetrahedralizeTest, TheSameBitsForAnyNumberOfThreads) {
  const TriangleMesh surface = SurfaceOf(MakeTorus({1, 0.4, 36, 8}));
  const MeshingResult one = Mesh(surface, 5000, 0, 1), three = Mesh(surface, 5000, 0, 3);
  EXPECT_EQ(one.mesh.nodes, three.mesh.nodes);
  EXPECT_EQ(one.mesh.tetrahedra, three.mesh.tetrahedra);
}

// Both error measures are of second order in the size.
TEST(TetrahedralizeTest, DistanceFromTheSurfaceFallsWithTheSize) {
  const TriangleMesh surface = SurfaceOf(MakeSphere(1, 32));
  const double coarse = Mesh(surface, 0, 0.36).report.surface_distance;
  const double fine = Mesh(surface, 0, 0.12).report.surface_distance;
  EXPECT_LT(coarse, 0.04);
  EXPECT_LT(fine, coarse / 4.5);
}

TEST(TetrahedralizeTest, ProgressGoesFromNothingToAll) {
  TriangleMesh surface = SurfaceOf(MakeSphere(1, 8));
  ThreadTeam team(1);
  Problems problems;
  MeshingOptions options;
  options.size = 0.3;
  std::vector<double> parts;
  ASSERT_TRUE(
      Tetrahedralize(surface, options, team, problems, [&](double part, const char*) { parts.push_back(part); }));
  EXPECT_EQ(parts.front(), 0);
  EXPECT_EQ(parts.back(), 1);
  EXPECT_TRUE(std::is_sorted(parts.begin(), parts.end()));
}

TEST(TetrahedralizeTest, StopsAtEveryStage) {
  const TriangleMesh surface = SurfaceOf(MakeSphere(1, 8));
  ThreadTeam team(1);
  Problems problems;
  MeshingOptions options;
  options.tetrahedra = 4000;
  std::size_t stages = 0;
  TriangleMesh copy = surface;
  ASSERT_TRUE(Tetrahedralize(copy, options, team, problems, [&](double, const char*) { ++stages; }));
  ASSERT_GE(stages, 5u);
  for (std::size_t last = 1; last <= stages; ++last) {
    std::stop_source source;
    team.HeedStop(source.get_token());
    std::size_t told = 0;
    const auto stop_at_last = [&](double, const char*) {
      if (++told == last) source.request_stop();
    };
    copy = surface;
    EXPECT_THROW(Tetrahedralize(copy, options, team, problems, stop_at_last), Stopped);
    EXPECT_EQ(told, last);
  }
  EXPECT_TRUE(problems.empty());
}

TEST(TetrahedralizeTest, CavitiesStayEmpty) {
  TriangleMesh small = SurfaceOf(MakeSphere(0.5, 16));
  const MeshingResult result = Mesh(Joined(SurfaceOf(MakeSphere(1, 24)), InsideOut(small)), 10000);
  EXPECT_NEAR(result.report.volume / (4 * std::numbers::pi / 3 * 0.875), 1, 0.01);
  for (std::size_t t = 0; t < result.mesh.tetrahedra.size(); ++t) {
    EXPECT_GT(Centroid(result.mesh, t).norm(), 0.48);
  }
}

TEST(TetrahedralizeTest, RefusesSeveralBodies) {
  const TriangleMesh sphere = SurfaceOf(MakeSphere(1, 8));
  EXPECT_THAT(MeshingProblemsOf(Joined(sphere, Moved(sphere, {3, 0, 0}))), HasSubstr("more than one body"));
}

// Two bodies that overlap: the volume inside of both counts twice.
TEST(TetrahedralizeTest, RefusesSurfacesThatCutThemselvesDeeply) {
  const TriangleMesh sphere = SurfaceOf(MakeSphere(1, 8));
  const std::string problems = MeshingProblemsOf(Joined(sphere, Moved(sphere, {1.03, 0.02, 0.01})));
  EXPECT_THAT(problems, HasSubstr("the surface intersects itself at (0.5"));
  EXPECT_THAT(problems, HasSubstr("pairs of triangles"));
}

TEST(TetrahedralizeTest, RefusesSizesThatMakeNoSense) {
  const TriangleMesh sphere = SurfaceOf(MakeSphere(1, 8));
  EXPECT_THAT(MeshingProblemsOf(sphere, 1e-4), HasSubstr("is the unit right?"));
  EXPECT_THAT(MeshingProblemsOf(sphere, 1e4), HasSubstr("too large for this surface"));
  EXPECT_THAT(MeshingProblemsOf({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 3, 2}}}),
              HasSubstr("hole at"));
}

// A cavity is left empty, whatever the orientation of its surface.
TEST(TetrahedralizeTest, CavitiesAreLeftEmpty) {
  TriangleMesh inner = SurfaceOf(MakeSphere(0.5, 12));
  for (const bool inverted : {false, true}) {
    const TriangleMesh outer = SurfaceOf(MakeSphere(1, 12));
    const MeshingResult result = Mesh(Joined(outer, inverted ? InsideOut(inner) : inner), 6000);
    EXPECT_NEAR(result.report.volume, EnclosedVolume(outer) - EnclosedVolume(inner), 1e-4);
    for (std::size_t t = 0; t < result.mesh.tetrahedra.size(); ++t) {
      EXPECT_GT(Centroid(result.mesh, t).norm(), 0.45);
    }
  }
}

}  // namespace
}  // namespace fascicle
