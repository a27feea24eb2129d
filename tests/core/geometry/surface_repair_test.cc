#include "core/geometry/surface_repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "core/base/stop.h"
#include "core/geometry/triangle_tree.h"
#include "surface_samples.h"

namespace fascicle {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TriangleMesh Sphere() { return SurfaceOf(MakeSphere(1, 12)); }

SurfaceReport Repair(TriangleMesh& surface, double largest_hole = 0.5) {
  Problems problems;
  SurfaceReport report = RepairSurface(surface, largest_hole, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  return report;
}

std::string RepairProblemsOf(TriangleMesh surface, double largest_hole = 0.5) {
  Problems problems;
  RepairSurface(surface, largest_hole, problems);
  EXPECT_FALSE(problems.empty());
  return problems.ToString();
}

TEST(SurfaceRepairTest, LeavesASoundSurfaceAlone) {
  TriangleMesh surface = Sphere();
  const TriangleMesh before = surface;
  const SurfaceReport report = Repair(surface);
  EXPECT_EQ(surface.nodes, before.nodes);
  EXPECT_EQ(surface.triangles, before.triangles);
  EXPECT_EQ(report.removed_triangles + report.turned_triangles, 0);
  EXPECT_EQ(report.parts, 1);
  EXPECT_TRUE(report.holes.empty() && report.cuts.empty());
}

TEST(SurfaceRepairTest, HeedsStopRequests) {
  TriangleMesh surface = Sphere();
  std::stop_source source;
  source.request_stop();
  Problems problems;
  EXPECT_THROW(RepairSurface(surface, 0.5, problems, source.get_token()), Stopped);
  EXPECT_THROW(TriangleTree(surface).CuttingPairs(source.get_token()), Stopped);
}

// Every triangle with nodes of its own; some reversed, some duplicated, some degenerate.
TEST(SurfaceRepairTest, MakesASurfaceOfASoup) {
  const TriangleMesh sound = Sphere();
  TriangleMesh soup;
  std::mt19937 random(3);
  const auto add = [&](const Triangle& t) {
    const auto first = static_cast<std::int32_t>(soup.nodes.size());
    for (const std::int32_t n : t) soup.nodes.push_back(sound.nodes[n]);
    soup.triangles.push_back({first, first + 1, first + 2});
  };
  for (Triangle t : sound.triangles) {
    if (random() % 3 == 0) std::swap(t[0], t[1]);
    add(t);
    if (random() % 8 == 0) add(t);
    if (random() % 8 == 0) add({t[0], t[1], t[0]});
  }
  const SurfaceReport report = Repair(soup);
  EXPECT_EQ(soup.nodes.size(), sound.nodes.size());
  EXPECT_EQ(soup.triangles.size(), sound.triangles.size());
  EXPECT_NEAR(EnclosedVolume(soup), EnclosedVolume(sound), 1e-12);
  EXPECT_GT(report.removed_triangles, 20);
  EXPECT_GT(report.turned_triangles, 50);
}

TEST(SurfaceRepairTest, FillsSmallHoles) {
  TriangleMesh surface = WithHole(WithHole(Sphere(), {0, 0, 1}, 0.1), {1, 0, 0}, 0.1);
  const SurfaceReport report = Repair(surface, 0.7);
  ASSERT_EQ(report.holes.size(), 2u);
  for (const SurfacePlace& hole : report.holes) {
    EXPECT_NEAR(hole.centre.norm(), 1, 0.1);
    EXPECT_LT(hole.extent, 0.7);
    EXPECT_GT(hole.length, 2 * hole.extent);
  }
  EXPECT_NEAR(EnclosedVolume(surface) / EnclosedVolume(Sphere()), 1, 0.02);
  EXPECT_EQ(Repair(surface).holes.size(), 0u) << "it is closed now";
}

// The least area of a boundary in a plane is that of the plane.
TEST(SurfaceRepairTest, FillsAFlatHoleExactly) {
  TriangleMesh surface = SurfaceOf(MakeBox({0, 0, 0}, {1, 1, 1}, {4, 4, 4}));
  std::erase_if(surface.triangles, [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](std::int32_t n) { return surface.nodes[n].z() == 1; });
  });
  const SurfaceReport report = Repair(surface, 2);
  ASSERT_EQ(report.holes.size(), 1u);
  EXPECT_NEAR(report.holes[0].length, 4, 1e-12);
  EXPECT_NEAR(report.holes[0].extent, std::sqrt(2), 1e-12);
  EXPECT_NEAR(EnclosedVolume(surface), 1, 1e-12);
  EXPECT_NEAR(Area(surface), 6, 1e-12);
}

TEST(SurfaceRepairTest, RefusesALargeHoleAndSaysWhere) {
  const std::string problems = RepairProblemsOf(WithHole(Sphere(), {0, 0, 1}, 0.6));
  EXPECT_THAT(problems, AllOf(HasSubstr("the surface has a hole at ("), HasSubstr("edges")));
}

TEST(SurfaceRepairTest, TurnsASurfaceThatIsInsideOut) {
  TriangleMesh surface = InsideOut(Sphere());
  const SurfaceReport report = Repair(surface);
  EXPECT_EQ(report.turned_triangles, static_cast<std::int64_t>(surface.triangles.size()));
  EXPECT_GT(EnclosedVolume(surface), 0);
}

// A part with inward normals stays so if it is a cavity, and is reversed if it is a body.
TEST(SurfaceRepairTest, TellsCavitiesFromBodies) {
  TriangleMesh small = Sphere();
  for (Vec3& node : small.nodes) node *= 0.5;
  TriangleMesh hollow = Joined(Sphere(), InsideOut(small));
  EXPECT_EQ(Repair(hollow).parts, 2);
  EXPECT_NEAR(EnclosedVolume(hollow) / EnclosedVolume(Sphere()), 1 - 0.125, 1e-9);
  TriangleMesh apart = Joined(Sphere(), InsideOut(Moved(small, {3, 0, 0})));
  EXPECT_EQ(Repair(apart).parts, 2);
  EXPECT_NEAR(EnclosedVolume(apart) / EnclosedVolume(Sphere()), 1 + 0.125, 1e-9);
}

TEST(SurfaceRepairTest, RefusesAOneSidedSurface) {
  // A Moebius strip of 12 squares.
  TriangleMesh strip;
  constexpr int kSquares = 12;
  for (int i = 0; i < kSquares; ++i) {
    const double angle = 2 * M_PI * i / kSquares;
    for (const double side : {-0.3, 0.3}) {
      const double r = 1 + side * std::cos(angle / 2);
      strip.nodes.push_back({r * std::cos(angle), r * std::sin(angle), side * std::sin(angle / 2)});
    }
  }
  for (int i = 0; i < kSquares; ++i) {
    const bool last = i == kSquares - 1;
    const std::int32_t a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    strip.triangles.push_back({a, b, c});
    strip.triangles.push_back({c, b, d});
  }
  EXPECT_THAT(RepairProblemsOf(strip), HasSubstr("one-sided"));
}

TEST(SurfaceRepairTest, RefusesASheetThatHangsOnTheSurface) {
  TriangleMesh surface = SurfaceOf(MakeBox({0, 0, 0}, {1, 1, 1}, {1, 1, 1}));
  const auto corner = std::find(surface.nodes.begin(), surface.nodes.end(), Vec3(0, 0, 0)) - surface.nodes.begin();
  const auto next = std::find(surface.nodes.begin(), surface.nodes.end(), Vec3(1, 0, 0)) - surface.nodes.begin();
  surface.nodes.push_back({0.5, -1, 0});
  surface.triangles.push_back({static_cast<std::int32_t>(corner), static_cast<std::int32_t>(next),
                               static_cast<std::int32_t>(surface.nodes.size() - 1)});
  EXPECT_THAT(RepairProblemsOf(surface, 0.1), HasSubstr("three or more triangles"));
}

TEST(SurfaceRepairTest, SaysWhereASurfaceCutsItself) {
  TriangleMesh surface = Joined(Sphere(), Moved(Sphere(), {1.7, 0.01, 0.02}));
  const SurfaceReport report = Repair(surface);
  ASSERT_EQ(report.cuts.size(), 1u);
  EXPECT_GT(report.cuts[0].count, 10);
  EXPECT_NEAR(report.cuts[0].centre.x(), 0.85, 0.1);
  EXPECT_NEAR(report.cuts[0].centre.y(), 0, 0.2);
}

TEST(SurfaceRepairTest, RefusesWhatHasNoArea) {
  EXPECT_THAT(RepairProblemsOf({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}}),
              HasSubstr("no triangles with an area"));
  // Back to back.
  EXPECT_THAT(RepairProblemsOf({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}}), HasSubstr("no triangles"));
}

}  // namespace
}  // namespace fascicle
