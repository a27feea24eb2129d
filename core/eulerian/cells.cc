#include "core/eulerian/cells.h"

#include <Eigen/LU>

#include "core/eulerian/cell_fraction.h"

namespace fascicle {
namespace {

// A smaller solid part of a cell has neither mass nor force.
constexpr double kSliver = 1e-3;
constexpr std::size_t kCellGrain = 256;

void SetCell(const EulerianBody& body, const EulerianState& state, std::size_t number, EulerianCells& cells) {
  const GridIndex at = body.grid.CellAt(number);
  std::array<double, 8> phi;
  bool known = true;
  for (int c = 0; c < 8; ++c) {
    const std::size_t node = body.grid.Corner(at, c);
    known &= state.known[node] != 0;
    phi[c] = cells.distance[node];
  }
  cells.inside[number] = known ? NegativeFraction(phi) : 0;
  if (cells.inside[number] < kSliver) {
    cells.inside[number] = 0;
    return;
  }
  Mat3 inverse = Mat3::Zero();
  for (int c = 0; c < 8; ++c) {
    inverse += state.X[body.grid.Corner(at, c)] * CornerGradient(c, body.grid.spacing).transpose();
  }
  cells.F[number] = inverse.inverse();
  cells.J[number] = 1 / inverse.determinant();
}

}  // namespace

void UpdateCells(const EulerianBody& body, const EulerianState& state, ThreadTeam& team, EulerianCells& cells) {
  const std::size_t count = body.grid.cell_count();
  cells.inside.assign(count, 0);
  cells.F.resize(count);
  cells.J.assign(count, 1);
  cells.distance.resize(state.X.size());
  team.For(state.X.size(), kCellGrain, [&](std::size_t begin, std::size_t end) {
    const double far = 10 * body.grid.spacing;
    for (std::size_t n = begin; n < end; ++n) {
      cells.distance[n] = state.known[n] != 0 ? body.shape.Distance(state.X[n]) : far;
    }
  });
  team.For(count, kCellGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) SetCell(body, state, c, cells);
  });
  cells.solid.clear();
  cells.smallest_J = cells.largest_J = 1;
  cells.valid = true;
  for (std::size_t c = 0; c < count; ++c) {
    if (cells.inside[c] == 0) continue;
    cells.solid.push_back(c);
    cells.smallest_J = std::min(cells.smallest_J, cells.J[c]);
    cells.largest_J = std::max(cells.largest_J, cells.J[c]);
    cells.valid &= cells.J[c] > 0 && cells.F[c].allFinite();
  }
}

double SolidVolume(const EulerianBody& body, const EulerianCells& cells) {
  double sum = 0;
  for (const std::size_t c : cells.solid) sum += cells.inside[c];
  return sum * std::pow(body.grid.spacing, 3);
}

}  // namespace fascicle
