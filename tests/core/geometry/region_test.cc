#include "core/geometry/region.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "core/geometry/shapes.h"
#include "core/geometry/triangle_distance.h"
#include "tests/support/mesh_samples.h"

namespace fascicle {
namespace {

constexpr double kPi = std::numbers::pi;

double Area(const TetMesh& mesh, const Region& region) {
  double area = 0;
  for (const auto& [a, b, c] : region.triangles) {
    area += (mesh.nodes[b] - mesh.nodes[a]).cross(mesh.nodes[c] - mesh.nodes[a]).norm() / 2;
  }
  return area;
}

void ExpectSortedAndComplete(const Region& region) {
  EXPECT_TRUE(std::is_sorted(region.nodes.begin(), region.nodes.end()));
  EXPECT_EQ(std::adjacent_find(region.nodes.begin(), region.nodes.end()), region.nodes.end());
  for (const Triangle& triangle : region.triangles) {
    for (const std::int32_t n : triangle) {
      EXPECT_TRUE(std::binary_search(region.nodes.begin(), region.nodes.end(), n));
    }
  }
}

class RegionTest : public ::testing::Test {
 protected:
  Region Select(const Selector& selector) const {
    Region region = SelectRegion(mesh_, BoundaryTriangles(mesh_), "part", selector);
    EXPECT_EQ(region.name, "part");
    ExpectSortedAndComplete(region);
    return region;
  }
  // 10 x 5 x 5 nodes on planes at multiples of 0.1, which have no exact representation.
  TetMesh mesh_ = MakeBox({0, 0, 0}, {0.9, 0.4, 0.4}, {9, 4, 4});
};

TEST_F(RegionTest, PlaneTakesNodesOnAndBeyondIt) {
  for (const double length : {1.0, 1e-3, 1e3}) {
    const Region end = Select(PlaneSelector{{0.9, 0, 0}, {length, 0, 0}});
    EXPECT_EQ(end.nodes.size(), 25u);
    EXPECT_NEAR(Area(mesh_, end), 0.16, 1e-15);
  }
  // 0.3 equals 3 * 0.1 only up to round-off.
  EXPECT_EQ(Select(PlaneSelector{{3 * 0.1, 0, 0}, {-1, 0, 0}}).nodes.size(), 100u);
  EXPECT_TRUE(Select(PlaneSelector{{0.91, 0, 0}, {1, 0, 0}}).nodes.empty());
}

// The tetrahedra under the side x = 0.9 down to a depth: those whose centroid is in that layer of the box.
TEST_F(RegionTest, SideWithDepthTakesALayer) {
  for (const double depth : {0.1, 0.2, 0.55}) {
    const Region layer = Select(SideSelector{{1, 0, 0}, 0.1, depth});
    EXPECT_EQ(layer.nodes.size(), 25u) << "the nodes stay those of the side";
    EXPECT_EQ(layer.elements, Select(PlaneSelector{{0.9 - depth, 0, 0}, {1, 0, 0}}).elements) << depth;
  }
  EXPECT_TRUE(Select(SideSelector{{1, 0, 0}, 0.1, 0}).elements.empty());
}

TEST_F(RegionTest, IntersectionIsWhatLiesInBoth) {
  const Region side = Select(SideSelector{{1, 0, 0}, 0.1, 0.1});
  const Region both = Intersection(side, Select(BoxSelector{{0, 0.2, 0}, {1, 0.4, 0.4}}));
  ExpectSortedAndComplete(both);
  EXPECT_EQ(both.name, "part");
  EXPECT_EQ(both.nodes.size(), 15u);
  EXPECT_NEAR(Area(mesh_, both), 0.08, 1e-15);
  EXPECT_EQ(both.elements.size(), side.elements.size() / 2);
  EXPECT_TRUE(Intersection(side, Select(PlaneSelector{{0.1, 0, 0}, {-1, 0, 0}})).nodes.empty());
}

// Material points of a region: beyond a plane, inside of boxes and spheres, or within a side's layer; all with a
// tolerance.
TEST_F(RegionTest, PointsAreInWhatItsSelectorsSay) {
  const auto contains = [&](const Selector& selector, const Vec3& x, double slack = 0.01) {
    return RegionPoints(Select(selector), mesh_.nodes, slack).Contain(x);
  };
  const PlaneSelector plane{{0.6, 0, 0}, {3, 0, 0}};
  EXPECT_TRUE(contains(plane, {0.8, 0.2, 0.2}));
  EXPECT_TRUE(contains(plane, {0.595, 0.2, 0.2}));
  EXPECT_FALSE(contains(plane, {0.58, 0.2, 0.2}));
  const BoxSelector box{{0, 0, 0}, {0.2, 0.4, 0.4}};
  EXPECT_TRUE(contains(box, {0.205, 0.1, 0.1}));
  EXPECT_FALSE(contains(box, {0.22, 0.1, 0.1}));
  const SphereSelector sphere{{0, 0, 0}, 0.2};
  EXPECT_TRUE(contains(sphere, {0.1, 0.1, 0.1}));
  EXPECT_FALSE(contains(sphere, {0.13, 0.13, 0.13}));
  const SideSelector layer{{1, 0, 0}, 0.1, 0.15};
  EXPECT_TRUE(contains(layer, {0.755, 0.2, 0.2}));
  EXPECT_FALSE(contains(layer, {0.735, 0.2, 0.2}));
  const Region both = Intersection(Select(plane), Select(BoxSelector{{0, 0, 0}, {0.9, 0.4, 0.2}}));
  EXPECT_TRUE(RegionPoints(both, mesh_.nodes, 0.01).Contain({0.7, 0.2, 0.1}));
  EXPECT_FALSE(RegionPoints(both, mesh_.nodes, 0.01).Contain({0.7, 0.2, 0.3}));
  EXPECT_FALSE(RegionPoints(both, mesh_.nodes, 0.01).Contain({0.3, 0.2, 0.1}));
}

TEST(TriangleDistanceTest, IsThatToTheNearestPoint) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_DOUBLE_EQ(SquaredDistance({0.2, 0.2, 0.5}, a, b, c), 0.25);                                 // above the inside
  EXPECT_DOUBLE_EQ(SquaredDistance({0.5, -2, 0}, a, b, c), 4);                                       // an edge
  EXPECT_DOUBLE_EQ(SquaredDistance({1, 1, 0}, a, b, c), 0.5);                                        // the slanted one
  EXPECT_DOUBLE_EQ(SquaredDistance({-3, -4, 0}, a, b, c), 25);                                       // a corner
  EXPECT_DOUBLE_EQ(SquaredDistance({0.5, 0.5, 1}, {0.5, 0.5, 0}, {0.5, 0.5, 0}, {0.5, 0.5, 0}), 1);  // of no area
}

// 9 x 4 x 4 hexahedra of six tetrahedra each: whole layers, because no centroid lies on a plane of nodes.
TEST_F(RegionTest, TetrahedraAreThoseWithTheirCentroidInside) {
  const auto count = [&](const Selector& selector) { return Select(selector).elements.size(); };
  EXPECT_EQ(count(PlaneSelector{{0.3, 0, 0}, {-1, 0, 0}}), 3u * 16u * 6u);
  EXPECT_EQ(count(PlaneSelector{{0.9, 0, 0}, {1, 0, 0}}), 0u);
  EXPECT_EQ(count(BoxSelector{{0.1, 0.1, 0.1}, {0.3, 0.2, 0.4}}), 2u * 1u * 3u * 6u);
  EXPECT_EQ(count(SphereSelector{{0.45, 0.2, 0.2}, 1}), mesh_.tetrahedra.size());
  EXPECT_EQ(count(SideSelector{{0, 0, 1}, 0.1}), 0u);
  mesh_.tetrahedron_tags.assign(mesh_.tetrahedra.size(), 1);
  mesh_.tetrahedron_tags[5] = mesh_.tetrahedron_tags[77] = 3;
  EXPECT_EQ(Select(TagSelector{3}).elements, (std::vector<std::int32_t>{5, 77}));
  mesh_.further_tags = {{77, 4}, {6, 3}, {5, 4}};
  EXPECT_EQ(Select(TagSelector{3}).elements, (std::vector<std::int32_t>{5, 6, 77}));
  EXPECT_EQ(Select(TagSelector{4}).elements, (std::vector<std::int32_t>{5, 77}));
}

TEST_F(RegionTest, BoxIncludesItsFaces) {
  EXPECT_EQ(Select(BoxSelector{{0.1, 0.1, 0.1}, {0.3, 0.2, 0.1}}).nodes.size(), 6u);
  EXPECT_EQ(Select(BoxSelector{{-1, -1, -1}, {1, 1, 1}}).nodes.size(), mesh_.nodes.size());
  EXPECT_EQ(Select(BoxSelector{{-1, -1, -1}, {1, 1, 1}}).triangles.size(), BoundaryTriangles(mesh_).size());
  EXPECT_TRUE(Select(BoxSelector{{0.11, 0.11, 0.11}, {0.19, 0.19, 0.19}}).nodes.empty());
}

TEST_F(RegionTest, SphereIncludesItsSurface) {
  EXPECT_EQ(Select(SphereSelector{{0.2, 0.2, 0.2}, 0.1}).nodes.size(), 7u);
  EXPECT_TRUE(Select(SphereSelector{{0.2, 0.2, 0.2}, 0.1}).triangles.empty()) << "inside of the body";
  EXPECT_EQ(Select(SphereSelector{{0, 0, 0}, 0.05}).nodes, std::vector<std::int32_t>{0});
}

TEST_F(RegionTest, SideTakesTrianglesThatFaceADirection) {
  const Region top = Select(SideSelector{{0, 0, 5}, 0.7});
  EXPECT_EQ(top.nodes.size(), 50u);
  EXPECT_NEAR(Area(mesh_, top), 0.9 * 0.4, 1e-15);
  for (const auto& [a, b, c] : top.triangles) {
    EXPECT_GT((mesh_.nodes[b] - mesh_.nodes[a]).cross(mesh_.nodes[c] - mesh_.nodes[a]).z(), 0);
  }
  EXPECT_NEAR(Area(mesh_, Select(SideSelector{{0, 0, 1}, kPi / 2})), 0.36 + 2 * 0.36 + 2 * 0.16, 1e-13);
  EXPECT_NEAR(Area(mesh_, Select(SideSelector{{0, 0, 1}, 3.2})), 2 * (0.36 + 0.36 + 0.16), 1e-13);
}

// A cap of a sphere of half angle a has the area 2 pi r^2 (1 - cos a).
TEST_F(RegionTest, SideOfASphereIsACap) {
  const TetMesh sphere = MakeSphere(1, 40);
  const Region cap = SelectRegion(sphere, BoundaryTriangles(sphere), "cap", SideSelector{{0, -2, 0}, 0.5});
  EXPECT_NEAR(Area(sphere, cap) / (2 * kPi * (1 - std::cos(0.5))), 1, 0.03);
  for (const std::int32_t n : cap.nodes) EXPECT_LT(sphere.nodes[n].y(), -std::cos(0.6));
}

class TagRegionTest : public ::testing::Test {
 protected:
  Region Select(std::int32_t tag) { return SelectRegion(mesh_, BoundaryTriangles(mesh_), "tagged", TagSelector{tag}); }
  TetMesh mesh_ = [] {
    Problems problems;
    return *ReadMesh({"m.msh", kGmsh2, ""}, problems);
  }();
};

// The file has the triangle 0 2 3 with the opposite orientation.
TEST_F(TagRegionTest, TrianglesAreTurnedOutward) {
  const Region region = Select(7);
  EXPECT_EQ(region.nodes, (std::vector<std::int32_t>{0, 2, 3}));
  EXPECT_EQ(region.triangles, (std::vector<Triangle>{{0, 3, 2}}));
}

// Point elements, in both versions: their nodes, and the surface between them.
TEST_F(TagRegionTest, PointsGiveNodesAndTheSurfaceBetweenThem) {
  Problems problems;
  const std::string three = Replaced(kGmsh2, "4\n1 15 2 0 1 1\n", "6\n1 15 2 9 1 1\n5 15 2 9 1 3\n6 15 2 9 1 4\n");
  mesh_ = ReadMesh({"m.msh", three, ""}, problems).value_or(TetMesh());
  ASSERT_TRUE(problems.empty()) << problems.ToString();
  const Region region = Select(9);
  EXPECT_EQ(region.nodes, (std::vector<std::int32_t>{0, 2, 3}));
  EXPECT_EQ(region.triangles, (std::vector<Triangle>{{0, 3, 2}}));
  EXPECT_TRUE(region.elements.empty());
  const std::string one = Replaced(kGmsh4, "1 0 0 0 0\n", "1 0 0 0 1 9\n");
  mesh_ = ReadMesh({"m.msh", one, ""}, problems).value_or(TetMesh());
  ASSERT_TRUE(problems.empty()) << problems.ToString();
  EXPECT_EQ(Select(9).nodes.size(), 1u);
  EXPECT_EQ(Select(7).triangles.size(), 1u) << "triangles stay as they are";
  const std::string missing = Replaced(kGmsh2, "1 15 2 0 1 1", "1 15 2 9 1 8");
  EXPECT_FALSE(ReadMesh({"m.msh", missing, ""}, problems).has_value());
  EXPECT_NE(problems.ToString().find("1 points refer to nodes that do not exist"), std::string::npos)
      << problems.ToString();
}

TEST_F(TagRegionTest, TetrahedraGiveNodesAndTheirPartOfTheSurface) {
  const Region region = Select(20);
  EXPECT_EQ(region.nodes, (std::vector<std::int32_t>{1, 2, 3, 4}));
  EXPECT_EQ(region.triangles.size(), 3u);
}

TEST_F(TagRegionTest, TrianglesGoBeforeTetrahedraOfTheSameTag) {
  mesh_.triangle_tags[0] = 20;
  EXPECT_EQ(Select(20).nodes, (std::vector<std::int32_t>{0, 2, 3}));
}

TEST_F(TagRegionTest, TrianglesInsideGiveNodesOnly) {
  mesh_.tagged_triangles[0] = {1, 2, 3};
  const Region region = Select(7);
  EXPECT_EQ(region.nodes, (std::vector<std::int32_t>{1, 2, 3}));
  EXPECT_TRUE(region.triangles.empty());
}

TEST_F(TagRegionTest, UnknownTagIsEmpty) { EXPECT_TRUE(Select(99).nodes.empty()); }

}  // namespace
}  // namespace fascicle
