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

// One of two opposite twins closes the surface; both go where they hang on it.
TEST(SurfaceRepairTest, KeepsOneOfTwoOppositeTriangles) {
  TriangleMesh surface = Sphere();
  surface.triangles.push_back(InsideOut(Sphere()).triangles[11]);
  EXPECT_EQ(Repair(surface, 0).removed_triangles, 1);
  EXPECT_EQ(surface.triangles.size(), Sphere().triangles.size());
  EXPECT_NEAR(EnclosedVolume(surface), EnclosedVolume(Sphere()), 1e-12);
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

// Where all surfaces are outward, the inner one is a cavity all the same; a body inside of that is a body.
TEST(SurfaceRepairTest, OrientationDoesNotMakeACavity) {
  const auto scaled = [](double factor) {
    TriangleMesh sphere = Sphere();
    for (Vec3& node : sphere.nodes) node *= factor;
    return sphere;
  };
  const double whole = EnclosedVolume(Sphere());
  for (const bool outer_inverted : {false, true}) {
    for (const bool inner_inverted : {false, true}) {
      for (const bool inner_first : {false, true}) {
        const TriangleMesh outer = outer_inverted ? InsideOut(Sphere()) : Sphere();
        const TriangleMesh inner = inner_inverted ? InsideOut(scaled(0.5)) : scaled(0.5);
        TriangleMesh hollow = inner_first ? Joined(inner, outer) : Joined(outer, inner);
        const SurfaceReport report = Repair(hollow);
        EXPECT_NEAR(EnclosedVolume(hollow) / whole, 1 - 0.125, 1e-9);
        ASSERT_EQ(report.cavities.size(), 1u);
        EXPECT_NEAR(report.cavities[0].centre.norm(), 0, 1e-9);
        EXPECT_NEAR(report.cavities[0].extent, std::sqrt(3), 1e-9);
        const bool turned_outer = outer_inverted, turned_inner = !inner_inverted;
        EXPECT_EQ(report.turned_triangles,
                  static_cast<std::int64_t>(outer.triangles.size()) * (turned_outer + turned_inner));
      }
    }
  }
  TriangleMesh nested = Joined(Joined(scaled(0.25), scaled(0.5)), Sphere());
  EXPECT_EQ(Repair(nested).cavities.size(), 1u);
  EXPECT_NEAR(EnclosedVolume(nested) / whole, 1 - 0.125 + 0.125 / 8, 1e-9);
  // Half inside is not inside.
  TriangleMesh overlapping = Joined(Sphere(), Moved(scaled(0.5), {1.01, 0.02, 0.03}));
  EXPECT_TRUE(Repair(overlapping).cavities.empty());
}

// Every triangle has corners of its own, each of them moved by less than the distance of welding.
TEST(SurfaceRepairTest, WeldsNearCorners) {
  const TriangleMesh sound = Sphere();
  TriangleMesh soup;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-2e-7, 2e-7);
  for (const Triangle& t : sound.triangles) {
    const auto first = static_cast<std::int32_t>(soup.nodes.size());
    for (const std::int32_t n : t) {
      soup.nodes.push_back(sound.nodes[n] + Vec3(uniform(random), uniform(random), uniform(random)));
    }
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const SurfaceReport report = Repair(soup);
  EXPECT_EQ(soup.nodes.size(), sound.nodes.size());
  EXPECT_EQ(soup.triangles.size(), sound.triangles.size());
  EXPECT_EQ(report.welded_nodes, static_cast<std::int64_t>(3 * sound.triangles.size() - sound.nodes.size()));
  EXPECT_NEAR(report.weld_distance, 1e-6 * std::sqrt(12), 1e-8);
  EXPECT_TRUE(report.holes.empty());
  EXPECT_NEAR(EnclosedVolume(soup), EnclosedVolume(sound), 1e-5);
}

// Near corners of a closed surface are detail, not a flaw.
TEST(SurfaceRepairTest, DoesNotWeldWhatIsClosed) {
  TriangleMesh small = SurfaceOf(MakeBox({0, 0, 0}, {1e-7, 1e-7, 1e-7}, {2, 2, 2}));
  TriangleMesh both = Joined(Sphere(), Moved(small, {2, 0, 0}));
  const TriangleMesh before = both;
  const SurfaceReport report = Repair(both);
  EXPECT_EQ(report.welded_nodes, 0);
  EXPECT_EQ(both.nodes, before.nodes);
}

// One side of a box has a corner on an edge that the other side lacks: with a triangle without area
// between them, without it, and for an edge much longer than the largest hole.
TEST(SurfaceRepairTest, ClosesSlits) {
  TriangleMesh box = SurfaceOf(MakeBox({0, 0, 0}, {1, 1, 1}, {1, 1, 1}));
  const auto node_at = [&](const Vec3& x) {
    return static_cast<std::int32_t>(std::find(box.nodes.begin(), box.nodes.end(), x) - box.nodes.begin());
  };
  const std::int32_t a = node_at({0, 0, 0}), b = node_at({1, 0, 0}),
                     middle = static_cast<std::int32_t>(box.nodes.size());
  box.nodes.push_back({0.4, 0, 0});
  TriangleMesh divided = box;
  for (std::size_t t = 0; t < divided.triangles.size(); ++t) {
    Triangle& triangle = divided.triangles[t];
    const auto at = std::find(triangle.begin(), triangle.end(), a) - triangle.begin();
    if (at == 3 || triangle[(at + 1) % 3] != b) continue;
    const std::int32_t c = triangle[(at + 2) % 3];
    divided.triangles.push_back({middle, b, c});
    divided.triangles[t] = {a, middle, c};
    break;
  }
  ASSERT_EQ(divided.triangles.size(), box.triangles.size() + 1);
  for (const bool with_sliver : {false, true}) {
    TriangleMesh surface = divided;
    if (with_sliver) surface.triangles.push_back({a, b, middle});
    const SurfaceReport report = Repair(surface, 0.01);
    EXPECT_EQ(report.closed_slits, 1);
    EXPECT_TRUE(report.holes.empty());
    EXPECT_DOUBLE_EQ(EnclosedVolume(surface), 1);
  }
}

// A triangle that is flat up to round-off, on an edge of a closed surface.
TEST(SurfaceRepairTest, RemovesSliversThatHangOnEdges) {
  TriangleMesh surface = Sphere();
  const Vec3 a = surface.nodes[surface.triangles[7][0]], b = surface.nodes[surface.triangles[7][1]];
  surface.nodes.push_back(0.3 * a + 0.7 * b + Vec3(0, 1e-9, 0));
  surface.triangles.push_back(
      {surface.triangles[7][0], surface.triangles[7][1], static_cast<std::int32_t>(surface.nodes.size() - 1)});
  const SurfaceReport report = Repair(surface);
  EXPECT_EQ(report.removed_triangles, 1);
  EXPECT_EQ(surface.triangles, Sphere().triangles);
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
