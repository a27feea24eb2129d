// Solid parts of cells, interpolation between nodes, and extrapolation beyond known ones.
#include <gtest/gtest.h>

#include "core/eulerian/cell_fraction.h"
#include "core/eulerian/extrapolation.h"
#include "core/eulerian/interpolation.h"

namespace fascicle::testing {
namespace {

std::array<double, 8> AtCorners(const Vec3& gradient, double constant) {
  std::array<double, 8> phi;
  for (int c = 0; c < 8; ++c) phi[c] = constant + gradient.dot(Vec3(c & 1, c >> 1 & 1, c >> 2));
  return phi;
}

// The volume below a plane in a cube with corners at 0 and 1, by inclusion and exclusion of corner pyramids, for a
// gradient without negative components: sum of (-1)^k max(0, d - sum of k components)^3 / (6 g1 g2 g3).
double BelowPlane(const Vec3& g, double d) {
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    const int count = (c & 1) + (c >> 1 & 1) + (c >> 2);
    const double left = d - g.dot(Vec3(c & 1, c >> 1 & 1, c >> 2));
    sum += (count % 2 == 0 ? 1 : -1) * std::pow(std::max(left, 0.0), 3);
  }
  return sum / (6 * g.prod());
}

TEST(CellFraction, IsExactForPlanes) {
  for (const Vec3& g : {Vec3(1, 2, 3), Vec3(0.1, 5, 1), Vec3(2, 2, 2.1)}) {
    for (const double part : {0.05, 0.2, 0.4, 0.5, 0.7, 0.95}) {
      const double d = part * g.sum();
      EXPECT_NEAR(NegativeFraction(AtCorners(g, -d)), BelowPlane(g, d), 1e-12);
      EXPECT_NEAR(NegativeFraction(AtCorners(-g, d)), 1 - BelowPlane(g, d), 1e-12);
    }
  }
  EXPECT_EQ(NegativeFraction(AtCorners(Vec3(1, 1, 1), 0.1)), 0);
  EXPECT_EQ(NegativeFraction(AtCorners(Vec3(1, 1, 1), -3.1)), 1);
}

EulerianGrid SmallGrid() {
  EulerianGrid grid;
  grid.origin = Vec3(1, -2, 0.5);
  grid.spacing = 0.25;
  grid.cells = {9, 8, 7};
  return grid;
}

Vec3 CubicField(const Vec3& x) {
  return {x[0] * x[0] * x[0] - x[1], x[0] * x[1] * x[2], x[2] * x[2] * x[2] + 2 * x[1] * x[1]};
}

TEST(Interpolation, IsExactForCubicsInsideAndForLinearFieldsAtTheSide) {
  const EulerianGrid grid = SmallGrid();
  std::vector<Vec3> cubic, linear;
  for (std::size_t n = 0; n < grid.node_count(); ++n) {
    const Vec3 x = grid.NodePosition(grid.NodeAt(n));
    cubic.push_back(CubicField(x));
    linear.push_back(2 * x + Vec3(1, 2, 3));
  }
  std::vector<std::uint8_t> known(grid.node_count(), 1);
  const Vec3 inside = grid.origin + Vec3(0.9, 0.6, 0.77), side = grid.origin + Vec3(0.1, 0.05, 1.7);
  EXPECT_LT((*Interpolate(grid, {&cubic, &known}, inside) - CubicField(inside)).norm(), 1e-12);
  EXPECT_LT((*Interpolate(grid, {&linear, &known}, side) - (2 * side + Vec3(1, 2, 3))).norm(), 1e-12);
  // One unknown node disables the cubic interpolation; an unknown corner of the cell disables all.
  const EulerianGrid::Place place = grid.PlaceOf(inside);
  known[grid.NodeNumber({place.cell[0] - 1, place.cell[1], place.cell[2]})] = 0;
  EXPECT_GT((*Interpolate(grid, {&cubic, &known}, inside) - CubicField(inside)).norm(), 1e-4);
  EXPECT_LT((*Interpolate(grid, {&linear, &known}, inside) - (2 * inside + Vec3(1, 2, 3))).norm(), 1e-12);
  known[grid.NodeNumber(place.cell)] = 0;
  EXPECT_FALSE(Interpolate(grid, {&linear, &known}, inside));
}

TEST(Extrapolation, CarriesLinearFieldsOn) {
  const EulerianGrid grid = SmallGrid();
  const Mat3 A = (Mat3() << 1, 0.2, 0, -0.3, 0.9, 0.1, 0, 0.4, 1.2).finished();
  const auto field_at = [&](const Vec3& x) { return Vec3(A * x + Vec3(0.1, 0.2, 0.3)); };
  std::vector<Vec3> field(grid.node_count(), Vec3::Constant(1e9));
  std::vector<std::uint8_t> known(grid.node_count(), 0);
  for (std::size_t n = 0; n < grid.node_count(); ++n) {
    const GridIndex at = grid.NodeAt(n);
    if (at[0] < 3 || at[0] > 5 || at[1] < 3 || at[1] > 5 || at[2] < 3 || at[2] > 5) continue;
    known[n] = 1;
    field[n] = field_at(grid.NodePosition(at));
  }
  ThreadTeam team(2);
  const Band band(grid, known, 3, team);
  band.Extend(2, 1, team, field);
  known = band.Known(2);
  std::size_t count = 0;
  for (std::size_t n = 0; n < grid.node_count(); ++n) {
    if (known[n] == 0) continue;
    ++count;
    EXPECT_LT((field[n] - field_at(grid.NodePosition(grid.NodeAt(n)))).norm(), 1e-4) << n;
  }
  EXPECT_EQ(count, 7u * 7 * 7);  // two layers around 3 x 3 x 3
  for (const NodeWeight& part : ExtrapolationWeights(grid, {0, 4, 4}, known)) EXPECT_TRUE(std::isfinite(part.weight));
  double sum = 0;
  for (const NodeWeight& part : ExtrapolationWeights(grid, {0, 4, 4}, known)) sum += part.weight;
  EXPECT_NEAR(sum, 1, 1e-10);
}

}  // namespace
}  // namespace fascicle::testing
