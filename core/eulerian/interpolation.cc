#include "core/eulerian/interpolation.h"

namespace fascicle {
namespace {

// Of the nodes at -1, 0, 1, 2 for a point at t in [0, 1].
std::array<double, 4> CubicWeights(double t) {
  return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
          (t + 1) * t * (t - 1) / 6};
}

std::optional<Vec3> Cubic(const EulerianGrid& grid, const KnownField& field, const EulerianGrid::Place& place) {
  for (int axis = 0; axis < 3; ++axis) {
    if (place.cell[axis] < 1 || place.cell[axis] + 2 > grid.cells[axis]) return std::nullopt;
  }
  std::array<std::array<double, 4>, 3> weights;
  for (int axis = 0; axis < 3; ++axis) weights[axis] = CubicWeights(place.within[axis]);
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 4; ++j) {
      std::size_t node = grid.NodeNumber({place.cell[0] - 1, place.cell[1] - 1 + j, place.cell[2] - 1 + k});
      Vec3 row = Vec3::Zero();
      for (int i = 0; i < 4; ++i, ++node) {
        if ((*field.known)[node] == 0) return std::nullopt;
        row += weights[0][i] * (*field.values)[node];
      }
      sum += weights[1][j] * weights[2][k] * row;
    }
  }
  return sum;
}

std::optional<Vec3> Linear(const EulerianGrid& grid, const KnownField& field, const EulerianGrid::Place& place) {
  Vec3 sum = Vec3::Zero();
  for (int c = 0; c < 8; ++c) {
    double weight = 1;
    for (int axis = 0; axis < 3; ++axis) weight *= (c >> axis & 1) != 0 ? place.within[axis] : 1 - place.within[axis];
    const std::size_t node = grid.Corner(place.cell, c);
    if ((*field.known)[node] == 0) return std::nullopt;
    sum += weight * (*field.values)[node];
  }
  return sum;
}

}  // namespace

std::optional<Vec3> Interpolate(const EulerianGrid& grid, const KnownField& field, const Vec3& point) {
  const EulerianGrid::Place place = grid.PlaceOf(point);
  if (const std::optional<Vec3> cubic = Cubic(grid, field, place)) return cubic;
  return Linear(grid, field, place);
}

}  // namespace fascicle
