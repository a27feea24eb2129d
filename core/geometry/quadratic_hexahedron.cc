#include "core/geometry/quadratic_hexahedron.h"

#include <Eigen/LU>
#include <algorithm>
#include <iterator>

namespace fascicle {
namespace {

double QuadraticWeight(int a, int d, const Vec3& x) { return QuadraticFactor(HexNodeStep(a, d), x[d]); }

}  // namespace

Vec3 TriquadraticValue(const QuadraticHexahedronNodes& values, const Vec3& x) {
  Vec3 sum = Vec3::Zero();
  for (int a = 0; a < 27; ++a) {
    const double weight = QuadraticWeight(a, 0, x) * QuadraticWeight(a, 1, x) * QuadraticWeight(a, 2, x);
    sum += weight * values[static_cast<std::size_t>(a)];
  }
  return sum;
}

Mat3 TriquadraticSlopes(const QuadraticHexahedronNodes& values, const Vec3& x) {
  Mat3 slopes = Mat3::Zero();
  for (int a = 0; a < 27; ++a) {
    for (int d = 0; d < 3; ++d) {
      const double across = QuadraticWeight(a, (d + 1) % 3, x) * QuadraticWeight(a, (d + 2) % 3, x);
      slopes.col(d) += QuadraticFactorSlope(HexNodeStep(a, d), x[d]) * across * values[static_cast<std::size_t>(a)];
    }
  }
  return slopes;
}

void FillSidesAndCentre(QuadraticHexahedronNodes& nodes) {
  const auto is_on = [](int a, std::size_t side) {
    // Sides are at the near and the far end of each axis in turn.
    const int axis = static_cast<int>(side) / 2, end = side % 2 == 0 ? 0 : 2;
    return HexNodeStep(a, axis) == end;
  };
  Vec3 corners = Vec3::Zero(), edges = Vec3::Zero(), sides = Vec3::Zero();
  for (std::size_t side = 0; side < 6; ++side) {
    Vec3& middle = nodes[20 + side];
    middle.setZero();
    for (int a = 0; a < 20; ++a) {
      if (is_on(a, side)) middle += (a < 8 ? -0.25 : 0.5) * nodes[static_cast<std::size_t>(a)];
    }
    sides += middle;
  }
  for (std::size_t a = 0; a < 8; ++a) corners += nodes[a];
  for (std::size_t a = 8; a < 20; ++a) edges += nodes[a];
  nodes[26] = 0.5 * sides - 0.25 * edges + 0.125 * corners;
}

bool IsUsable(const QuadraticHexahedronNodes& nodes) {
  constexpr double kPlaces[3] = {0.11270166537925831148, 0.5, 1 - 0.11270166537925831148};  // (1 - sqrt(3/5)) / 2
  constexpr double kWeights[3] = {5. / 18, 4. / 9, 5. / 18};
  double parts[4] = {};
  for (int q = 0; q < 27; ++q) {
    const int i = q % 3, j = q / 3 % 3, k = q / 9;
    const Vec3 x(kPlaces[i], kPlaces[j], kPlaces[k]);
    const double J = TriquadraticSlopes(nodes, x).determinant();
    if (!(J > 0)) return false;
    for (int c = 0; c < 4; ++c) {
      parts[c] += kWeights[i] * kWeights[j] * kWeights[k] * J * LinearPart(c, x[0], x[1], x[2]);
    }
  }
  return std::all_of(std::begin(parts), std::end(parts), [](double part) { return part > 0; });
}

}  // namespace fascicle
