#include "core/eulerian/velocity_program.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "core/eulerian/cell_blocks.h"
#include "core/eulerian/stiffness.h"

namespace fascicle {
namespace {

constexpr double kTolerance = 1e-7;
constexpr std::size_t kProgramGrain = 64;
// Number of cells along each axis whose pressures are corrected together.
constexpr std::int32_t kGroup = 4;
// Largest relative change of a cell's volume in a step; the remaining error of the map is corrected later.
constexpr double kMostGain = 0.1;

// Rows of contact whose normals cancel to this part of their area, squared, say nothing.
constexpr double kCancels = 1e-12;

// How the velocity of a node changes the volume of a block of cells [m^2].
struct NodeFlux {
  std::size_t node;
  Vec3 flux;
};
using CellFluxes = std::vector<NodeFlux>;  // by ascending nodes, without duplicates

// The fluxes of blocks of cells, one block after the other.
struct BlockFluxes {
  std::unique_ptr<NodeFlux[]> parts;
  std::vector<std::size_t> begin;  // start of each block in `parts`
  std::vector<std::size_t> size;   // number of fluxes of each block

  std::size_t count() const { return size.size(); }
  std::span<const NodeFlux> operator[](std::size_t block) const { return {parts.get() + begin[block], size[block]}; }
};

// Adds V grad N of the corners of a cell; constrained nodes are replaced by their root nodes.
void AddFluxes(const EulerianBody& body, const EulerianCells& cells, const NodeRoles& roles, std::size_t cell,
               CellFluxes& all) {
  const GridIndex at = body.grid.CellAt(cell);
  const double volume = cells.inside[cell] * std::pow(body.grid.spacing, 3);
  for (int c = 0; c < 8; ++c) {
    const Vec3 flux = volume * CornerGradient(c, body.grid.spacing);
    roles.ForRoots(body.grid.Corner(at, c), [&](std::size_t node, double weight) {
      all.push_back({node, weight * flux});
    });
  }
}

// Upper bound for the number of nodes in a block's fluxes.
std::size_t MostNodes(const EulerianGrid& grid, const NodeRoles& roles, std::span<const std::size_t> block) {
  std::size_t count = 0;
  for (const std::size_t cell : block) {
    const GridIndex at = grid.CellAt(cell);
    for (int c = 0; c < 8; ++c) roles.ForRoots(grid.Corner(at, c), [&](std::size_t, double) { ++count; });
  }
  return count;
}

BlockFluxes Fluxes(const EulerianBody& body, const EulerianCells& cells, const NodeRoles& roles,
                   const CellBlocks& blocks, ThreadTeam& team) {
  BlockFluxes fluxes;
  fluxes.size.resize(blocks.count());
  team.For(blocks.count(), kProgramGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) fluxes.size[b] = MostNodes(body.grid, roles, blocks[b]);
  });
  fluxes.begin.resize(blocks.count());
  std::exclusive_scan(fluxes.size.begin(), fluxes.size.end(), fluxes.begin.begin(), std::size_t{0});
  // Left uninitialized, so that page faults are taken in parallel.
  fluxes.parts =
      std::make_unique_for_overwrite<NodeFlux[]>(blocks.count() == 0 ? 0 : fluxes.begin.back() + fluxes.size.back());
  team.For(blocks.count(), kProgramGrain, [&](std::size_t begin, std::size_t end) {
    CellFluxes own;
    for (std::size_t b = begin; b < end; ++b) {
      own.clear();
      for (const std::size_t cell : blocks[b]) AddFluxes(body, cells, roles, cell, own);
      MergeByNode(own, [](NodeFlux& sum, const NodeFlux& part) { sum.flux += part.flux; });
      fluxes.size[b] = own.size();
      std::copy(own.begin(), own.end(), fluxes.parts.get() + fluxes.begin[b]);
    }
  });
  return fluxes;
}

// The required rate of volume change of a cell [m^3/s].
double Gain(const EulerianBody& body, const EulerianCells& cells, std::size_t cell, double dt) {
  if (body.volume != VolumeTreatment::kPreserved) return 0;
  const double part = std::clamp(1 / cells.J[cell] - 1, -kMostGain, kMostGain);
  return cells.inside[cell] * std::pow(body.grid.spacing, 3) * part / dt;
}

}  // namespace

// A body's columns and rows.
struct VelocityProgram::Block {
  Block(const Part& p, int node, int row, double dt, ThreadTeam& team);

  void AddVolumeRows(double dt, ThreadTeam& team, ConstraintRows& rows) const;
  void AddStabilization(double dt, std::vector<int>& begin, std::vector<int>& column, std::vector<double>& value) const;
  void AddGroups(std::vector<int>& groups, int& count) const;

  Part part;
  CellBlocks blocks;
  BlockFluxes fluxes;
  std::vector<int> of_node;     // for each node: its index among the body's free ones; -1: not free
  std::vector<int> free_nodes;  // for each block of cells: its number of free nodes
  std::vector<int> of_block;    // for each block of cells: its row among the body's; -1: none
  int nodes = 0, rows = 0;
  int first_node, first_row;  // among those of all bodies
  std::optional<ElasticStiffness> stiffness;
};

VelocityProgram::Block::Block(const Part& p, int node, int row, double dt, ThreadTeam& team)
    : part(p), first_node(node), first_row(row) {
  const EulerianBody& body = *p.body;
  if (body.volume != VolumeTreatment::kNone) blocks = MakeCellBlocks(body.grid, *p.cells, team);
  fluxes = Fluxes(body, *p.cells, *p.roles, blocks, team);
  of_node.assign(p.velocity->size(), -1);
  for (std::size_t n = 0; n < of_node.size(); ++n) {
    if (p.roles->IsFree(n)) of_node[n] = nodes++;
  }
  of_block.resize(fluxes.count());
  free_nodes.resize(fluxes.count());
  team.For(fluxes.count(), kProgramGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      for (const NodeFlux& flux : fluxes[b]) free_nodes[b] += of_node[flux.node] >= 0 ? 1 : 0;
    }
  });
  for (std::size_t b = 0; b < fluxes.count(); ++b) of_block[b] = free_nodes[b] > 0 ? rows++ : -1;
  if (body.implicit_elasticity && nodes > 0) {
    stiffness.emplace(body, *p.state, *p.controls, *p.cells, *p.roles, of_node, dt, team);
  }
}

// Prescribed velocities go to the right-hand side.
void VelocityProgram::Block::AddVolumeRows(double dt, ThreadTeam& team, ConstraintRows& all) const {
  const int* const begin = all.G.outerIndexPtr();
  int* const column = all.G.innerIndexPtr();
  double* const value = all.G.valuePtr();
  team.For(fluxes.count(), kProgramGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b) {
      if (of_block[b] < 0) continue;
      const int row = first_row + of_block[b];
      double right = 0;
      for (const std::size_t cell : blocks[b]) right += Gain(*part.body, *part.cells, cell, dt);
      int place = begin[row];
      for (const NodeFlux& flux : fluxes[b]) {
        const int node = of_node[flux.node];
        if (node < 0) right -= flux.flux.dot((*part.velocity)[flux.node]);
        for (int d = 0; d < 3 && node >= 0; ++d, ++place) {
          column[place] = 3 * (first_node + node) + d;
          value[place] = flux.flux[d];
        }
      }
      all.b[row] = right;
    }
  });
}

// eps L between blocks whose first cells share a face, of the size of the volume constraints' own matrix there: h/rho
// times their solid parts. It is weighted by the square of (step of waves / step), so that its effect on the volumes of
// a body at rest does not depend on the step, and a step shortened by a frame causes no disturbance.
void VelocityProgram::Block::AddStabilization(double dt, std::vector<int>& begin, std::vector<int>& column,
                                              std::vector<double>& value) const {
  const EulerianGrid& grid = part.body->grid;
  const EulerianCells& cells = *part.cells;
  std::vector<int> row_of(grid.cell_count(), -1);
  for (std::size_t b = 0; b < blocks.count(); ++b) row_of[blocks.First(b)] = of_block[b];
  const double longer = part.waves / dt;
  const double weight = part.body->stabilization * longer * longer * grid.spacing / part.body->density;
  const std::array<std::ptrdiff_t, 3> along = {1, grid.cells[0],
                                               static_cast<std::ptrdiff_t>(grid.cells[0]) * grid.cells[1]};
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    if (of_block[b] < 0) continue;
    const std::size_t cell = blocks.First(b);
    const GridIndex at = grid.CellAt(cell);
    double sum = 0;
    std::size_t own = 0;
    const auto add = [&](int axis, int side) {
      const std::int32_t next = at[axis] + side;
      if (next < 0 || next >= grid.cells[axis]) return;
      const std::size_t other = cell + side * along[axis];
      if (row_of[other] < 0) return;
      const double w = weight * std::sqrt(cells.inside[cell] * cells.inside[other]);
      column.push_back(first_row + row_of[other]);
      value.push_back(-w);
      sum += w;
    };
    for (const int axis : {2, 1, 0}) add(axis, -1);
    own = value.size();
    column.push_back(first_row + of_block[b]);
    value.push_back(0);
    for (const int axis : {0, 1, 2}) add(axis, 1);
    value[own] = sum;
    begin.push_back(static_cast<int>(column.size()));
  }
}

// The cube of neighbouring cells that contains each row; `count` is the number of cubes so far.
void VelocityProgram::Block::AddGroups(std::vector<int>& groups, int& count) const {
  const EulerianGrid& grid = part.body->grid;
  const auto along = [&](int axis) { return static_cast<std::size_t>((grid.cells[axis] + kGroup - 1) / kGroup); };
  std::vector<int> used(along(0) * along(1) * along(2), -1);
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    if (of_block[b] < 0) continue;
    const GridIndex at = grid.CellAt(blocks.First(b));
    int& group = used[at[0] / kGroup + along(0) * (at[1] / kGroup + along(1) * (at[2] / kGroup))];
    if (group < 0) group = count++;
    groups[first_row + of_block[b]] = group;
  }
}

VelocityProgram::VelocityProgram(double dt, ThreadTeam& team) : dt_(dt), team_(team) {}

VelocityProgram::~VelocityProgram() = default;

void VelocityProgram::AddBody(const Part& part) {
  const Block& block = *blocks_.emplace_back(std::make_unique<Block>(part, nodes_, rows_, dt_, team_));
  nodes_ += block.nodes;
  rows_ += block.rows;
}

QpStatus VelocityProgram::Solve() {
  if (nodes_ == 0) return QpStatus::kSolved;  // every node is prescribed
  QuadraticProgram problem;
  SetMasses(problem);
  SetVolumes(problem);
  SetStabilization(problem);
  SetGroups(problem);
  SetStiffness(problem);
  SetContacts(problem);
  const QpReport report = SolveQp(problem, {.tolerance = kTolerance, .team = &team_}, solution_);
  iterations_ = std::accumulate(report.minres_iterations.begin(), report.minres_iterations.end(), 0);
  residual_ = std::max({report.stationarity, report.feasibility, report.complementarity});
  return report.status;
}

int VelocityProgram::iterations() const { return iterations_; }

double VelocityProgram::residual() const { return residual_; }

void VelocityProgram::SetMasses(QuadraticProgram& problem) const {
  problem.p.resize(3 * nodes_);
  Eigen::VectorXd mass(3 * nodes_);
  for (const auto& block : blocks_) {
    const std::vector<double>& of_body = block->part.forces->mass;
    team_.For(of_body.size(), kProgramGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        if (block->of_node[n] < 0) continue;
        const int number = 3 * (block->first_node + block->of_node[n]);
        mass.segment<3>(number).setConstant(of_body[n]);
        problem.p.segment<3>(number) = of_body[n] * (*block->part.velocity)[n];
      }
    });
  }
  problem.M = Eigen::SparseMatrix<double>(mass.asDiagonal());
}

void VelocityProgram::SetVolumes(QuadraticProgram& problem) const {
  ConstraintRows& rows = problem.volumes;
  rows.b.resize(rows_);
  rows.G.resize(rows_, 3 * nodes_);
  int* const begin = rows.G.outerIndexPtr();
  begin[0] = 0;
  for (const auto& block : blocks_) {
    for (std::size_t b = 0; b < block->fluxes.count(); ++b) {
      const int row = block->first_row + block->of_block[b];
      if (block->of_block[b] >= 0) begin[row + 1] = begin[row] + 3 * block->free_nodes[b];
    }
  }
  rows.G.resizeNonZeros(begin[rows_]);
  for (const auto& block : blocks_) block->AddVolumeRows(dt_, team_, rows);
}

void VelocityProgram::SetStabilization(QuadraticProgram& problem) const {
  std::vector<int> begin = {0}, column;
  std::vector<double> value;
  for (const auto& block : blocks_) block->AddStabilization(dt_, begin, column, value);
  // The matrix is symmetric, so rows and columns are the same.
  problem.E = Eigen::Map<const Eigen::SparseMatrix<double>>(rows_, rows_, begin.back(), begin.data(), column.data(),
                                                            value.data());
}

void VelocityProgram::SetGroups(QuadraticProgram& problem) const {
  problem.groups.resize(static_cast<std::size_t>(rows_));
  int count = 0;
  for (const auto& block : blocks_) block->AddGroups(problem.groups, count);
}

void VelocityProgram::SetStiffness(QuadraticProgram& problem) {
  const bool any = std::any_of(blocks_.begin(), blocks_.end(), [](const auto& b) { return b->stiffness.has_value(); });
  if (!any) return;
  const auto columns = [](const Block& block, auto& vector) {
    return vector.segment(3 * block.first_node, 3 * block.nodes);
  };
  problem.added_diagonal = Eigen::VectorXd::Zero(3 * nodes_);
  for (const auto& block : blocks_) {
    if (!block->stiffness) continue;
    columns(*block, problem.p) -= block->stiffness->OfPrescribed(*block->part.velocity);
    columns(*block, problem.added_diagonal) = block->stiffness->Diagonal();
  }
  problem.add_product = [this, columns](const Eigen::VectorXd& v, Eigen::VectorXd& product) {
    for (const auto& block : blocks_) {
      if (block->stiffness) block->stiffness->AddProduct(columns(*block, v), columns(*block, product));
    }
  };
}

void VelocityProgram::AddContact(ContactRow row) {
  double squares = 0;
  for (const ContactPart& part : row.parts) {
    if (blocks_[part.body]->of_node[part.node] >= 0) squares += part.weight.squaredNorm();
  }
  if (squares > kCancels * row.area * row.area) contacts_.push_back(std::move(row));
}

// Adds a row of a contact and returns its right-hand side, which includes prescribed velocities.
double VelocityProgram::AddRow(const ContactRow& row, int number, std::vector<Eigen::Triplet<double>>& entries) const {
  double right = row.least;
  for (const ContactPart& part : row.parts) {
    const Block& block = *blocks_[part.body];
    const int node = block.of_node[part.node];
    if (node < 0) {
      if (block.part.roles->IsPrescribed(part.node)) right -= part.weight.dot((*block.part.velocity)[part.node]);
      continue;
    }
    for (int d = 0; d < 3; ++d) entries.emplace_back(number, 3 * (block.first_node + node) + d, part.weight[d]);
  }
  return right;
}

// A row starts as active if the velocities v* violate it.
void VelocityProgram::SetContacts(QuadraticProgram& problem) {
  const auto count = static_cast<Eigen::Index>(contacts_.size());
  if (count == 0) return;
  std::vector<Eigen::Triplet<double>> entries;
  ConstraintRows& rows = problem.inequalities;
  rows.b.resize(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    rows.b[k] = AddRow(contacts_[static_cast<std::size_t>(k)], static_cast<int>(k), entries);
  }
  rows.G.resize(count, 3 * nodes_);
  rows.G.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd velocity = problem.p.cwiseQuotient(Eigen::VectorXd(problem.M.diagonal()));
  const Eigen::VectorXd excess = rows.G * velocity - rows.b;
  for (const double value : excess) solution_.active.push_back(value < 0);
}

// Calls each(node, impulse) for each share of a body's nodes in the contacts.
template <class Each>
void VelocityProgram::ForContacts(std::size_t body, const Each& each) const {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const double impulse = solution_.contact[static_cast<Eigen::Index>(k)];
    for (const ContactPart& part : contacts_[k].parts) {
      if (part.body == body) each(part.node, Vec3(impulse * part.weight));
    }
  }
}

void VelocityProgram::TakeBody(std::size_t body, std::vector<Vec3>& velocity, std::vector<double>& pressure,
                               std::vector<Vec3>& impulses) const {
  const Block& block = *blocks_[body];
  if (block.nodes == 0) return;
  team_.For(velocity.size(), kProgramGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      if (block.of_node[n] >= 0) velocity[n] = solution_.v.segment<3>(3 * (block.first_node + block.of_node[n]));
    }
  });
  std::vector<Vec3> pushed(impulses.size(), Vec3::Zero());
  if (block.stiffness && !pushed.empty()) block.stiffness->AddPrescribedImpulses(velocity, pushed);
  for (std::size_t b = 0; b < block.fluxes.count(); ++b) {
    if (block.of_block[b] < 0) continue;
    const double multiplier = solution_.volumes[block.first_row + block.of_block[b]];
    for (const std::size_t cell : block.blocks[b]) pressure[cell] = multiplier / dt_;
    for (const NodeFlux& flux : pushed.empty() ? std::span<const NodeFlux>() : block.fluxes[b]) {
      if (block.part.roles->IsPrescribed(flux.node)) pushed[flux.node] += multiplier * flux.flux;
    }
  }
  if (!pushed.empty()) {
    ForContacts(body, [&](std::size_t node, const Vec3& impulse) {
      if (block.part.roles->IsPrescribed(node)) pushed[node] += impulse;
    });
  }
  for (std::size_t n = 0; n < impulses.size(); ++n) impulses[n] -= pushed[n];
}

Resultant VelocityProgram::ContactImpulse(std::size_t body) const {
  const EulerianGrid& grid = blocks_[body]->part.body->grid;
  Resultant sum;
  ForContacts(body, [&](std::size_t node, const Vec3& impulse) {
    sum.sum += impulse;
    sum.moment += grid.NodePosition(grid.NodeAt(node)).cross(impulse);
  });
  return sum;
}

void VelocityProgram::AddFloorImpulses(std::vector<Vec3>& impulses) const {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    if (contacts_[k].floor < 0) continue;
    const double impulse = solution_.contact[static_cast<Eigen::Index>(k)];
    for (const ContactPart& part : contacts_[k].parts) {
      const Block& block = *blocks_[part.body];
      const GridFrame frame(block.part.state->pose, block.part.body->travels);
      impulses[contacts_[k].floor] += frame.VectorInWorld(impulse * part.weight);
    }
  }
}

}  // namespace fascicle
