#include "core/eulerian/projection.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <optional>
#include <span>

#include "core/eulerian/cell_blocks.h"
#include "core/eulerian/stiffness.h"

namespace fascicle {
namespace {

constexpr double kTolerance = 1e-7;
constexpr std::size_t kGrain = 64;
// Cells along each axis whose pressures are corrected together.
constexpr std::int32_t kGroup = 4;
// The most volume that a cell is to gain or lose in a step, of its own: what the map says beyond is made up for later.
constexpr double kMostGain = 0.1;

// What a node's velocity makes of the volume of a block of cells [m^2].
struct NodeFlux {
  std::size_t node;
  Vec3 flux;
};
using CellFluxes = std::vector<NodeFlux>;  // by rising nodes, each once

// The fluxes of blocks, one block after the other.
struct BlockFluxes {
  std::unique_ptr<NodeFlux[]> parts;
  std::vector<std::size_t> begin;  // of each block, in `parts`
  std::vector<std::size_t> size;   // of each block

  std::size_t count() const { return size.size(); }
  std::span<const NodeFlux> operator[](std::size_t block) const { return {parts.get() + begin[block], size[block]}; }
};

// Adds V grad N of the corners of a cell, in place of those that follow others of whom they follow.
void AddFluxes(const EulerianBody& body, const EulerianCells& cells, const NodalForces& nodes, std::size_t cell,
               CellFluxes& all) {
  const GridIndex at = body.grid.CellAt(cell);
  const double volume = cells.inside[cell] * std::pow(body.grid.spacing, 3);
  for (int c = 0; c < 8; ++c) {
    const Vec3 flux = volume * CornerGradient(c, body.grid.spacing);
    nodes.ForMovers(body.grid.Corner(at, c), [&](std::size_t node, double weight) {
      all.push_back({node, weight * flux});
    });
  }
}

// The most nodes that a block's fluxes can name.
std::size_t MostNodes(const EulerianGrid& grid, const NodalForces& nodes, std::span<const std::size_t> block) {
  std::size_t count = 0;
  for (const std::size_t cell : block) {
    const GridIndex at = grid.CellAt(cell);
    for (int c = 0; c < 8; ++c) nodes.ForMovers(grid.Corner(at, c), [&](std::size_t, double) { ++count; });
  }
  return count;
}

BlockFluxes Fluxes(const EulerianBody& body, const EulerianCells& cells, const NodalForces& nodes,
                   const CellBlocks& blocks, ThreadTeam& team) {
  BlockFluxes fluxes;
  fluxes.size.resize(blocks.count());
  team.For(blocks.count(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) fluxes.size[b] = MostNodes(body.grid, nodes, blocks[b]);
  });
  fluxes.begin.resize(blocks.count());
  std::exclusive_scan(fluxes.size.begin(), fluxes.size.end(), fluxes.begin.begin(), std::size_t{0});
  // Not set here: who writes to fresh memory first waits for it, which is better done by all threads.
  fluxes.parts =
      std::make_unique_for_overwrite<NodeFlux[]>(blocks.count() == 0 ? 0 : fluxes.begin.back() + fluxes.size.back());
  team.For(blocks.count(), kGrain, [&](std::size_t begin, std::size_t end) {
    CellFluxes own;
    for (std::size_t b = begin; b < end; ++b) {
      own.clear();
      for (const std::size_t cell : blocks[b]) AddFluxes(body, cells, nodes, cell, own);
      MergeByNode(own, [](NodeFlux& sum, const NodeFlux& part) { sum.flux += part.flux; });
      fluxes.size[b] = own.size();
      std::copy(own.begin(), own.end(), fluxes.parts.get() + fluxes.begin[b]);
    }
  });
  return fluxes;
}

// The problem's numbering: free nodes with three velocities each, and the blocks of cells that have any.
struct Numbering {
  std::vector<int> of_node;     // -1: not free
  std::vector<int> free_nodes;  // of each block, how many
  std::vector<int> of_block;    // -1: it has none
  int nodes = 0, rows = 0;
};

Numbering Number(const NodalForces& nodes, const BlockFluxes& fluxes, ThreadTeam& team) {
  Numbering numbers;
  numbers.of_node.assign(nodes.mass.size(), -1);
  for (std::size_t n = 0; n < nodes.mass.size(); ++n) {
    if (nodes.mass[n] > 0 && nodes.support[n] < 0) numbers.of_node[n] = numbers.nodes++;
  }
  numbers.of_block.resize(fluxes.count());
  numbers.free_nodes.resize(fluxes.count());
  team.For(fluxes.count(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      for (const NodeFlux& part : fluxes[b]) numbers.free_nodes[b] += numbers.of_node[part.node] >= 0 ? 1 : 0;
    }
  });
  for (std::size_t b = 0; b < fluxes.count(); ++b) {
    numbers.of_block[b] = numbers.free_nodes[b] > 0 ? numbers.rows++ : -1;
  }
  return numbers;
}

// What a cell is to gain of volume per time [m^3/s].
double Gain(const EulerianBody& body, const EulerianCells& cells, std::size_t cell, double dt) {
  if (body.volume != VolumeTreatment::kPreserved) return 0;
  const double part = std::clamp(1 / cells.J[cell] - 1, -kMostGain, kMostGain);
  return cells.inside[cell] * std::pow(body.grid.spacing, 3) * part / dt;
}

// The rows of the volumes; what held nodes do to a volume goes to its right side.
ConstraintRows VolumeRows(const EulerianBody& body, const EulerianCells& cells, const CellBlocks& blocks,
                          const Numbering& numbers, const BlockFluxes& fluxes, const std::vector<Vec3>& velocity,
                          double dt, ThreadTeam& team) {
  ConstraintRows rows;
  rows.b.resize(numbers.rows);
  rows.G.resize(numbers.rows, 3 * numbers.nodes);
  int* const begin = rows.G.outerIndexPtr();
  begin[0] = 0;
  for (std::size_t c = 0; c < fluxes.count(); ++c) {
    const int row = numbers.of_block[c];
    if (row >= 0) begin[row + 1] = begin[row] + 3 * numbers.free_nodes[c];
  }
  rows.G.resizeNonZeros(begin[numbers.rows]);
  int* const column = rows.G.innerIndexPtr();
  double* const value = rows.G.valuePtr();
  team.For(fluxes.count(), kGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t c = first; c < last; ++c) {
      const int row = numbers.of_block[c];
      if (row < 0) continue;
      double right = 0;
      for (const std::size_t cell : blocks[c]) right += Gain(body, cells, cell, dt);
      int place = begin[row];
      for (const NodeFlux& part : fluxes[c]) {
        const int node = numbers.of_node[part.node];
        if (node < 0) right -= part.flux.dot(velocity[part.node]);
        for (int d = 0; d < 3 && node >= 0; ++d, ++place) {
          column[place] = 3 * node + d;
          value[place] = part.flux[d];
        }
      }
      rows.b[row] = right;
    }
  });
  return rows;
}

// eps L between blocks whose first cells share a face, as large as the volumes' own matrix there: h/rho times their
// solid parts. The shorter the step beside that of waves, the more of it: what it does to the volumes of a body at rest
// then does not depend on the step, and a step that a frame cuts short upsets nothing.
Eigen::SparseMatrix<double> Stabilization(const EulerianBody& body, const EulerianCells& cells,
                                          const CellBlocks& blocks, const Numbering& numbers, const StepLength& step) {
  const EulerianGrid& grid = body.grid;
  std::vector<int> row_of(grid.cell_count(), -1);
  for (std::size_t c = 0; c < blocks.count(); ++c) row_of[blocks.First(c)] = numbers.of_block[c];
  const double longer = step.waves / step.dt;
  const double weight = body.stabilization * longer * longer * grid.spacing / body.density;
  const std::array<std::ptrdiff_t, 3> along = {1, grid.cells[0],
                                               static_cast<std::ptrdiff_t>(grid.cells[0]) * grid.cells[1]};
  std::vector<int> begin = {0}, column;
  std::vector<double> value;
  for (std::size_t c = 0; c < blocks.count(); ++c) {
    if (numbers.of_block[c] < 0) continue;
    const std::size_t cell = blocks.First(c);
    const GridIndex at = grid.CellAt(cell);
    double sum = 0;
    std::size_t own = 0;
    const auto add = [&](int axis, int side) {
      const std::int32_t next = at[axis] + side;
      if (next < 0 || next >= grid.cells[axis]) return;
      const std::size_t other = cell + side * along[axis];
      if (row_of[other] < 0) return;
      const double w = weight * std::sqrt(cells.inside[cell] * cells.inside[other]);
      column.push_back(row_of[other]);
      value.push_back(-w);
      sum += w;
    };
    for (const int axis : {2, 1, 0}) add(axis, -1);
    own = value.size();
    column.push_back(numbers.of_block[c]);
    value.push_back(0);
    for (const int axis : {0, 1, 2}) add(axis, 1);
    value[own] = sum;
    begin.push_back(static_cast<int>(column.size()));
  }
  // Symmetric: the same by rows and by columns.
  return Eigen::Map<const Eigen::SparseMatrix<double>>(numbers.rows, numbers.rows, begin.back(), begin.data(),
                                                       column.data(), value.data());
}

// Which block of cells each row belongs to.
std::vector<int> Groups(const EulerianBody& body, const CellBlocks& blocks, const Numbering& numbers) {
  const GridIndex size = body.grid.cells;
  const auto along = [&](int axis) { return static_cast<std::size_t>((size[axis] + kGroup - 1) / kGroup); };
  std::vector<int> used(along(0) * along(1) * along(2), -1);
  std::vector<int> groups(static_cast<std::size_t>(numbers.rows));
  int count = 0;
  for (std::size_t c = 0; c < blocks.count(); ++c) {
    if (numbers.of_block[c] < 0) continue;
    const GridIndex at = body.grid.CellAt(blocks.First(c));
    int& group = used[at[0] / kGroup + along(0) * (at[1] / kGroup + along(1) * (at[2] / kGroup))];
    if (group < 0) group = count++;
    groups[numbers.of_block[c]] = group;
  }
  return groups;
}

void SetMasses(const NodalForces& nodes, const Numbering& numbers, const std::vector<Vec3>& velocity, ThreadTeam& team,
               QuadraticProgram& problem) {
  problem.p.resize(3 * numbers.nodes);
  Eigen::VectorXd mass(3 * numbers.nodes);
  team.For(nodes.mass.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const int number = numbers.of_node[n];
      if (number < 0) continue;
      mass.segment<3>(3 * number).setConstant(nodes.mass[n]);
      problem.p.segment<3>(3 * number) = nodes.mass[n] * velocity[n];
    }
  });
  problem.M = Eigen::SparseMatrix<double>(mass.asDiagonal());
}

}  // namespace

Projection ProjectVelocity(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                           const NodalForces& nodes, const StepLength& step, ThreadTeam& team,
                           std::vector<Vec3>& velocity, std::vector<double>& pressure) {
  const double dt = step.dt;
  const CellBlocks blocks =
      body.volume == VolumeTreatment::kNone ? CellBlocks() : MakeCellBlocks(body.grid, cells, team);
  const BlockFluxes fluxes = Fluxes(body, cells, nodes, blocks, team);
  const Numbering numbers = Number(nodes, fluxes, team);
  Projection result;
  result.held_impulses.assign(body.supports > 0 ? velocity.size() : 0, Vec3::Zero());
  if (numbers.nodes == 0) {  // supports hold all of the body
    result.report.status = QpStatus::kSolved;
    return result;
  }
  QuadraticProgram problem;
  SetMasses(nodes, numbers, velocity, team, problem);
  problem.volumes = VolumeRows(body, cells, blocks, numbers, fluxes, velocity, dt, team);
  problem.E = Stabilization(body, cells, blocks, numbers, step);
  problem.groups = Groups(body, blocks, numbers);
  std::optional<ElasticStiffness> stiffness;
  if (body.implicit_elasticity) {
    stiffness.emplace(body, state, cells, nodes, numbers.of_node, dt, team);
    problem.p -= stiffness->OfHeld(velocity);
    problem.added_diagonal = stiffness->Diagonal();
    problem.add_product = [&](const Eigen::VectorXd& v, Eigen::VectorXd& product) {
      stiffness->AddProduct(v, product);
    };
  }
  QpSolution solution;
  result.report = SolveQp(problem, {.tolerance = kTolerance, .team = &team}, solution);
  if (solution.v.size() == 0) return result;
  team.For(velocity.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      if (numbers.of_node[n] >= 0) velocity[n] = solution.v.segment<3>(3 * numbers.of_node[n]);
    }
  });
  if (stiffness && body.supports > 0) stiffness->AddHeldImpulses(velocity, result.held_impulses);
  for (std::size_t c = 0; c < fluxes.count(); ++c) {
    if (numbers.of_block[c] < 0) continue;
    const double multiplier = solution.volumes[numbers.of_block[c]];
    for (const std::size_t cell : blocks[c]) pressure[cell] = multiplier / dt;
    for (const NodeFlux& part : body.supports > 0 ? fluxes[c] : std::span<const NodeFlux>()) {
      if (nodes.support[part.node] >= 0) result.held_impulses[part.node] += multiplier * part.flux;
    }
  }
  return result;
}

}  // namespace fascicle
