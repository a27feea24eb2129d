#include "core/geometry/ear_clipping.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "core/base/stop.h"

namespace fascicle {
namespace {

using Corners = std::vector<Vec3>;

std::vector<std::int64_t> InOrder(std::size_t count) {
  std::vector<std::int64_t> polygon(count);
  std::iota(polygon.begin(), polygon.end(), 0);
  return polygon;
}

double Cross2(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

// Of a polygon in the plane z = 0.
double SignedArea(const Corners& corners) {
  double area = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    area += Cross2(corners[0], corners[i], corners[(i + 1) % corners.size()]) / 2;
  }
  return area;
}

bool Cut(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return Cross2(a, b, c) * Cross2(a, b, d) <= 0 && Cross2(c, d, a) * Cross2(c, d, b) <= 0;
}

// Random points in an order without crossings: two edges that cross are uncrossed by reversing what is between them,
// which shortens the polygon.
Corners RandomPolygon(std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  Corners corners;
  for (std::size_t i = 0; i < count; ++i) corners.emplace_back(uniform(random), uniform(random), 0);
  for (bool crossed = true; crossed;) {
    crossed = false;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 2; j < count; ++j) {
        if (i == 0 && j == count - 1) continue;
        if (!Cut(corners[i], corners[i + 1], corners[j], corners[(j + 1) % count])) continue;
        std::reverse(corners.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                     corners.begin() + static_cast<std::ptrdiff_t>(j) + 1);
        crossed = true;
      }
    }
  }
  if (SignedArea(corners) < 0) std::reverse(corners.begin(), corners.end());
  return corners;
}

// Two more corners on every third edge.
Corners WithStraightCorners(const Corners& corners) {
  Corners more;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    more.push_back(corners[i]);
    const Vec3& next = corners[(i + 1) % corners.size()];
    for (const double t : {0.25, 0.75}) {
      if (i % 3 == 0) more.push_back((1 - t) * corners[i] + t * next);
    }
  }
  return more;
}

// Every corner is used, the triangles have the polygon's orientation and its area, and none is flat.
void ExpectSplit(const Corners& corners, const std::vector<Triangle>& triangles) {
  ASSERT_EQ(triangles.size(), corners.size() - 2);
  std::vector<char> used(corners.size());
  double area = 0;
  for (const auto& [a, b, c] : triangles) {
    const double twice = Cross2(corners[a], corners[b], corners[c]);
    const double longest = std::max(
        {(corners[b] - corners[a]).norm(), (corners[c] - corners[b]).norm(), (corners[a] - corners[c]).norm()});
    EXPECT_GT(twice, 1e-10 * longest * longest);
    area += twice / 2;
    used[a] = used[b] = used[c] = 1;
  }
  // Triangles without overlap have this area; any overlap would add to it.
  EXPECT_NEAR(area, SignedArea(corners), 1e-12 * corners.size());
  EXPECT_EQ(std::count(used.begin(), used.end(), 1), static_cast<std::ptrdiff_t>(corners.size()));
}

TEST(EarClippingTest, RandomPolygonsKeepTheirArea) {
  std::mt19937 random(11);
  for (int round = 0; round < 200; ++round) {
    const Corners corners = RandomPolygon(4 + random() % 40, random);
    ExpectSplit(corners, SplitPolygon(corners, InOrder(corners.size())));
  }
}

TEST(EarClippingTest, CornersOnStraightLinesAreKept) {
  std::mt19937 random(12);
  for (int round = 0; round < 200; ++round) {
    const Corners corners = WithStraightCorners(RandomPolygon(4 + random() % 20, random));
    ExpectSplit(corners, SplitPolygon(corners, InOrder(corners.size())));
  }
}

// The triangles do not depend on where the polygon lies, up to round-off; here they are the same.
TEST(EarClippingTest, AnyPlane) {
  std::mt19937 random(13);
  const Corners flat = RandomPolygon(30, random);
  const std::vector<Triangle> expected = SplitPolygon(flat, InOrder(flat.size()));
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 2, 3)}) {
    for (const double angle : {0.5, 1.6, 2.5}) {
      Corners turned;
      for (const Vec3& x : flat) turned.push_back(Eigen::AngleAxisd(angle, axis.normalized()) * x + Vec3(5, 6, 7));
      double area = 0;
      const Vec3 normal = Eigen::AngleAxisd(angle, axis.normalized()) * Vec3::UnitZ();
      for (const auto& [a, b, c] : SplitPolygon(turned, InOrder(turned.size()))) {
        area += (turned[b] - turned[a]).cross(turned[c] - turned[a]).dot(normal) / 2;
      }
      EXPECT_NEAR(area, SignedArea(flat), 1e-10);
    }
  }
  EXPECT_EQ(expected.size(), flat.size() - 2);
}

TEST(EarClippingTest, AFanStaysAFan) {
  const Corners square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_EQ(SplitPolygon(square, InOrder(4)), (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
}

// A square with a square hole, along a bridge that is walked twice.
TEST(EarClippingTest, BridgesToHoles) {
  const Corners nodes = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {1, 1, 0}, {3, 1, 0}, {3, 3, 0}, {1, 3, 0}};
  const std::vector<std::int64_t> polygon = {0, 1, 2, 3, 0, 4, 7, 6, 5, 4};
  double area = 0;
  for (const auto& [a, b, c] : SplitPolygon(nodes, polygon)) {
    const double twice = Cross2(nodes[a], nodes[b], nodes[c]);
    EXPECT_GT(twice, 0);
    area += twice / 2;
  }
  EXPECT_DOUBLE_EQ(area, 12);
}

TEST(EarClippingTest, RepeatedCornersAreLeftOut) {
  const Corners nodes = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  EXPECT_EQ(SplitPolygon(nodes, std::vector<std::int64_t>{0, 1, 2, 2}), (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_EQ(SplitPolygon(nodes, std::vector<std::int64_t>{0, 0, 1, 2, 0}), (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_TRUE(SplitPolygon(nodes, std::vector<std::int64_t>{0, 1, 1, 0}).empty());
}

// Polygons without any ear end, too.
TEST(EarClippingTest, PolygonsThatIntersectThemselvesAreSplitSomehow) {
  std::mt19937 random(14);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int round = 0; round < 50; ++round) {
    Corners corners;
    for (int i = 0; i < 25; ++i) corners.emplace_back(uniform(random), uniform(random), uniform(random));
    EXPECT_EQ(SplitPolygon(corners, InOrder(25)).size(), 23u);
  }
  EXPECT_EQ(SplitPolygon(Corners(5, Vec3::Ones()), InOrder(5)).size(), 3u);
}

TEST(EarClippingTest, HeedsStopRequests) {
  Corners zigzag;
  for (int i = 0; i < 1000; ++i) zigzag.emplace_back(i, i % 2 ? 1 : 0.5, 0);
  zigzag.emplace_back(1000, -1, 0);
  zigzag.emplace_back(-1, -1, 0);
  std::reverse(zigzag.begin(), zigzag.end());
  ExpectSplit(zigzag, SplitPolygon(zigzag, InOrder(zigzag.size())));
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(SplitPolygon(zigzag, InOrder(zigzag.size()), source.get_token()), Stopped);
}

}  // namespace
}  // namespace fascicle
