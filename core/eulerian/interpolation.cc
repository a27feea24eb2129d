#include "core/eulerian/interpolation.h"

namespace fascicle {
namespace {

// The weights along an axis of `count` consecutive nodes, the first one `before` nodes before the place.
template <int count>
using Weights = std::array<std::array<double, count>, 3>;

// Lagrange polynomials for nodes at -1, 0, 1, 2 at t in [0, 1], and their derivatives.
std::array<double, 4> CubicWeights(double t) {
  return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
          (t + 1) * t * (t - 1) / 6};
}
std::array<double, 4> CubicSlopes(double t) {
  return {-(3 * t * t - 6 * t + 2) / 6, (3 * t * t - 4 * t - 1) / 2, -(3 * t * t - 2 * t - 2) / 2, (3 * t * t - 1) / 6};
}

// Whether the nodes first .. first + count - 1 along each axis are in the grid and known.
template <int count>
bool AllKnown(const EulerianGrid& grid, const KnownField& field, const GridIndex& first) {
  for (int axis = 0; axis < 3; ++axis) {
    if (first[axis] < 0 || first[axis] + count - 1 > grid.cells[axis]) return false;
  }
  for (int k = 0; k < count; ++k) {
    for (int j = 0; j < count; ++j) {
      const std::uint8_t* row = field.known->data() + grid.NodeNumber({first[0], first[1] + j, first[2] + k});
      for (int i = 0; i < count; ++i) {
        if (row[i] == 0) return false;
      }
    }
  }
  return true;
}

template <int count>
Vec3 WeightedSum(const EulerianGrid& grid, const KnownField& field, const GridIndex& first,
                 const std::array<double, count>& x, const std::array<double, count>& y,
                 const std::array<double, count>& z) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < count; ++k) {
    for (int j = 0; j < count; ++j) {
      const Vec3* row = field.values->data() + grid.NodeNumber({first[0], first[1] + j, first[2] + k});
      Vec3 of_row = Vec3::Zero();
      for (int i = 0; i < count; ++i) of_row += x[i] * row[i];
      sum += y[j] * z[k] * of_row;
    }
  }
  return sum;
}

// Tricubic or trilinear interpolation from the nodes around a place.
template <int count>
struct Stencil {
  GridIndex first;
  Weights<count> weights, slopes;  // slopes per cell

  Vec3 Value(const EulerianGrid& grid, const KnownField& field) const {
    return WeightedSum<count>(grid, field, first, weights[0], weights[1], weights[2]);
  }
  ValueAndGradient Both(const EulerianGrid& grid, const KnownField& field) const {
    ValueAndGradient both{Value(grid, field), {}};
    both.gradient.col(0) = WeightedSum<count>(grid, field, first, slopes[0], weights[1], weights[2]) / grid.spacing;
    both.gradient.col(1) = WeightedSum<count>(grid, field, first, weights[0], slopes[1], weights[2]) / grid.spacing;
    both.gradient.col(2) = WeightedSum<count>(grid, field, first, weights[0], weights[1], slopes[2]) / grid.spacing;
    return both;
  }
};

Stencil<4> Cubic(const EulerianGrid::Place& place) {
  Stencil<4> stencil;
  for (int axis = 0; axis < 3; ++axis) {
    stencil.first[axis] = place.cell[axis] - 1;
    stencil.weights[axis] = CubicWeights(place.within[axis]);
    stencil.slopes[axis] = CubicSlopes(place.within[axis]);
  }
  return stencil;
}

Stencil<2> Linear(const EulerianGrid::Place& place) {
  Stencil<2> stencil;
  stencil.first = place.cell;
  for (int axis = 0; axis < 3; ++axis) {
    stencil.weights[axis] = {1 - place.within[axis], place.within[axis]};
    stencil.slopes[axis] = {-1, 1};
  }
  return stencil;
}

}  // namespace

std::optional<Vec3> Interpolate(const EulerianGrid& grid, const KnownField& field, const Vec3& point) {
  const EulerianGrid::Place place = grid.PlaceOf(point);
  const Stencil<4> cubic = Cubic(place);
  if (AllKnown<4>(grid, field, cubic.first)) return cubic.Value(grid, field);
  if (AllKnown<2>(grid, field, place.cell)) return Linear(place).Value(grid, field);
  return std::nullopt;
}

std::optional<ValueAndGradient> InterpolateWithGradient(const EulerianGrid& grid, const KnownField& field,
                                                        const Vec3& point) {
  const EulerianGrid::Place place = grid.PlaceOf(point);
  const Stencil<4> cubic = Cubic(place);
  if (AllKnown<4>(grid, field, cubic.first)) return cubic.Both(grid, field);
  if (AllKnown<2>(grid, field, place.cell)) return Linear(place).Both(grid, field);
  return std::nullopt;
}

}  // namespace fascicle
