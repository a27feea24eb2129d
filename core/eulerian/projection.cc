#include "core/eulerian/projection.h"

namespace fascicle {
namespace {

constexpr double kTolerance = 1e-7;

using Triplets = std::vector<Eigen::Triplet<double>>;

// Numbers of the unknown nodes, three velocities each.
std::vector<int> UnknownNodes(const NodalForces& nodes, int& count) {
  std::vector<int> number(nodes.mass.size(), -1);
  count = 0;
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (nodes.mass[n] > 0 && nodes.held[n] == 0) number[n] = count++;
  }
  return number;
}

// eps L between solid cells that share a face, as large as the volumes' own matrix there: h/rho times their solid
// parts.
void AddStabilization(const EulerianBody& body, const EulerianCells& cells, const std::vector<int>& row_of,
                      Triplets& entries) {
  const double weight = body.stabilization * body.grid.spacing / body.density;
  for (const std::size_t cell : cells.solid) {
    const GridIndex at = body.grid.CellAt(cell);
    for (int axis = 0; axis < 3; ++axis) {
      GridIndex next = at;
      if (++next[axis] >= body.grid.cells[axis]) continue;
      const std::size_t other = body.grid.CellNumber(next);
      if (row_of[cell] < 0 || row_of[other] < 0) continue;
      const double w = weight * std::sqrt(cells.inside[cell] * cells.inside[other]);
      const int a = row_of[cell], b = row_of[other];
      entries.emplace_back(a, a, w);
      entries.emplace_back(b, b, w);
      entries.emplace_back(a, b, -w);
      entries.emplace_back(b, a, -w);
    }
  }
}

}  // namespace

QpReport ProjectVelocity(const EulerianBody& body, const EulerianCells& cells, const NodalForces& nodes, double dt,
                         std::vector<Vec3>& velocity) {
  int unknowns = 0;
  const std::vector<int> number = UnknownNodes(nodes, unknowns);
  std::vector<int> row_of(body.grid.cell_count(), -1);
  Triplets mass, volumes, stabilization;
  QuadraticProgram problem;
  problem.p.resize(3 * unknowns);
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (number[n] < 0) continue;
    for (int d = 0; d < 3; ++d) {
      mass.emplace_back(3 * number[n] + d, 3 * number[n] + d, nodes.mass[n]);
      problem.p[3 * number[n] + d] = nodes.mass[n] * velocity[n][d];
    }
  }
  const double cell_volume = std::pow(body.grid.spacing, 3);
  std::vector<double> right;
  for (const std::size_t cell : cells.solid) {
    const GridIndex at = body.grid.CellAt(cell);
    const double volume = cells.inside[cell] * cell_volume, J = cells.J[cell];
    const int row = static_cast<int>(right.size());
    bool any = false;
    const auto add = [&](std::size_t of, const Vec3& gradient) {
      if (number[of] < 0) return;
      any = true;
      for (int d = 0; d < 3; ++d) volumes.emplace_back(row, 3 * number[of] + d, gradient[d]);
    };
    for (int c = 0; c < 8; ++c) {
      const std::size_t corner = body.grid.Corner(at, c);
      const Vec3 gradient = volume * CornerGradient(c, body.grid.spacing);
      add(corner, gradient);
      for (const NodeWeight& part : nodes.leaders[corner]) add(part.node, part.weight * gradient);
    }
    if (!any) continue;
    row_of[cell] = row;
    right.push_back(body.volume == VolumeTreatment::kPreserved ? volume * (1 - J) / (dt * J) : 0);
  }
  AddStabilization(body, cells, row_of, stabilization);
  const auto rows = static_cast<Eigen::Index>(right.size());
  problem.M.resize(3 * unknowns, 3 * unknowns);
  problem.M.setFromTriplets(mass.begin(), mass.end());
  problem.volumes.G.resize(rows, 3 * unknowns);
  problem.volumes.G.setFromTriplets(volumes.begin(), volumes.end());
  problem.volumes.b = Eigen::Map<const Eigen::VectorXd>(right.data(), rows);
  problem.E.resize(rows, rows);
  problem.E.setFromTriplets(stabilization.begin(), stabilization.end());
  QpSolution solution;
  const QpReport report = SolveQp(problem, {.tolerance = kTolerance}, solution);
  if (solution.v.size() == 0) return report;
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (number[n] >= 0) velocity[n] = solution.v.segment<3>(3 * number[n]);
  }
  return report;
}

}  // namespace fascicle
