#include "core/eulerian/forces.h"

#include <Eigen/LU>

#include <memory>

#include "core/eulerian/plasticity.h"

namespace fascicle {
namespace {

// Of a shear modulus, for a pattern as steep as a strain.
constexpr double kPatternStiffness = 0.1;

// V sigma of a cell [J], its mass [kg], the force on it that is given [N], and what its patterns of the map push with
// at each corner [N].
struct CellForce {
  std::array<Vec3, kPatterns> pattern;
  Mat3 stress;
  double mass;
  Vec3 given;
};

// Patterns g = 1/8 sum of +-X have an energy of 1/2 k V |2 g/h|^2 each [Flanagan & Belytschko 1981, of the reference
// map in place of displacements]; X moves by -F^-1 v dt, so v is pushed by the F^-T of that energy's gradient.
void SetPatterns(const EulerianBody& body, const EulerianState& state, const GridIndex& cell, const Mat3& F,
                 double volume, CellForce& force) {
  const Mat3 inverse_transpose = F.inverse().transpose();
  for (int a = 0; a < kPatterns; ++a) {
    Vec3 g = Vec3::Zero();
    for (int c = 0; c < 8; ++c) g += CornerPattern(a, c) / 8.0 * state.X[body.grid.Corner(cell, c)];
    force.pattern[a] = PatternStiffness(body, volume) / 8 * inverse_transpose * g;
  }
}

CellForce ForceOf(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells, std::size_t cell) {
  const Vec3 none = Vec3::Zero();
  CellForce result = {{none, none, none, none}, Mat3::Zero(), 0, none};
  if (cells.inside[cell] == 0) return result;
  const double volume = cells.inside[cell] * std::pow(body.grid.spacing, 3);
  const GridIndex at = body.grid.CellAt(cell);
  const FibreState fibre = FibreOf(body, state, at);
  const Mat3 Fe = ElasticGradient(body, state, cells, cell);
  result.stress = volume * CauchyStress(body, Fe, fibre);
  SetPatterns(body, state, at, cells.F[cell], volume, result);
  result.mass = volume * body.density / cells.J[cell];
  if (body.force) result.given = volume * body.force(body.grid.CellCentre(at), state.time);
  return result;
}

// A node keeps at least that part of its own mass, whatever the extrapolation takes away: at edges it takes more than
// there is.
constexpr double kLeastMass = 0.3;

// Nodes nearer to the surface than that are outside [cells]: else round-off would tell for those that a surface along
// the grid goes through.
constexpr double kSkin = 1e-3;

// Which nodes are inside, which are held, and whom the others follow.
void SetLeaders(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells, ThreadTeam& team,
                NodalForces& nodes) {
  const std::size_t count = nodes.mass.size();
  nodes.support.assign(count, -1);
  nodes.inside.assign(count, 0);
  const double skin = -kSkin * body.grid.spacing;
  team.For(count, 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) nodes.inside[n] = nodes.mass[n] > 0 && cells.distance[n] < skin ? 1 : 0;
  });
  if (body.support_of) {
    team.For(count, 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        if (nodes.mass[n] > 0) nodes.support[n] = body.support_of(state.X[n]);
      }
    });
  }
  nodes.followers.clear();
  for (std::size_t n = 0; n < count; ++n) {
    if (nodes.mass[n] > 0 && nodes.inside[n] == 0 && nodes.support[n] < 0) nodes.followers.push_back({n, {}});
  }
  team.For(nodes.followers.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      NodalForces::Follower& follower = nodes.followers[f];
      follower.leaders = ExtrapolationWeights(body.grid, body.grid.NodeAt(follower.node), nodes.inside);
    }
  });
  nodes.follower_of.assign(count, -1);
  for (std::size_t f = 0; f < nodes.followers.size(); ++f) {
    if (!nodes.followers[f].leaders.empty()) nodes.follower_of[nodes.followers[f].node] = static_cast<std::int32_t>(f);
  }
}

void HandToInside(ThreadTeam& team, NodalForces& nodes) {
  nodes.own_mass = nodes.mass;
  for (const NodalForces::Follower& follower : nodes.followers) {
    for (const NodeWeight& part : follower.leaders) {
      nodes.mass[part.node] += part.weight * nodes.mass[follower.node];
      nodes.force[part.node] += part.weight * nodes.force[follower.node];
    }
    nodes.mass[follower.node] = 0;
    nodes.force[follower.node].setZero();
  }
  team.For(nodes.mass.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      if (nodes.inside[n] != 0) nodes.mass[n] = std::max(nodes.mass[n], kLeastMass * nodes.own_mass[n]);
    }
  });
}

// What a force at a point acts on: the nodes with mass at the corners of its cell, by its place in there; where there
// are none, those within two cells, nearer ones more.
std::vector<NodeWeight> NodesUnder(const EulerianGrid& grid, const std::vector<double>& mass, const Vec3& point) {
  const EulerianGrid::Place place = grid.PlaceOf(point);
  std::vector<NodeWeight> parts;
  double total = 0;
  const auto add = [&](const GridIndex& at, double weight) {
    if (!grid.HasNode(at) || weight <= 0 || mass[grid.NodeNumber(at)] == 0) return;
    parts.push_back({grid.NodeNumber(at), weight});
    total += weight;
  };
  const auto [i, j, k] = place.cell;
  for (int c = 0; c < 8; ++c) {
    add({i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)}, CornerWeight(c, place.within));
  }
  const bool none_at_corners = parts.empty();
  for (int n = 0; n < 216 && none_at_corners; ++n) {
    const GridIndex at = {i - 2 + n % 6, j - 2 + n / 6 % 6, k - 2 + n / 36};
    add(at, grid.spacing * grid.spacing / (grid.NodePosition(at) - point).squaredNorm());
  }
  for (NodeWeight& part : parts) part.weight /= total;
  return parts;
}

void AddVertexForces(const EulerianBody& body, const EulerianState& state, NodalForces& nodes) {
  std::vector<Vec3> forces(state.surface.size(), Vec3::Zero());
  body.vertex_forces(state.time, forces);
  for (std::size_t v = 0; v < forces.size(); ++v) {
    if (forces[v].isZero(0)) continue;
    for (const NodeWeight& part : NodesUnder(body.grid, nodes.mass, state.surface[v])) {
      nodes.force[part.node] += part.weight * forces[v];
    }
  }
}

}  // namespace

int CornerPattern(int pattern, int c) {
  const int x = (c & 1) != 0 ? 1 : -1, y = (c & 2) != 0 ? 1 : -1, z = (c & 4) != 0 ? 1 : -1;
  return pattern == 0 ? y * z : pattern == 1 ? z * x : pattern == 2 ? x * y : x * y * z;
}

double PatternStiffness(const EulerianBody& body, double volume) {
  const double shear = std::visit([](const auto& law) { return law.ShearModulus(); }, body.material);
  return kPatternStiffness * shear * volume * 4 / (body.grid.spacing * body.grid.spacing);
}

FibreState FibreOf(const EulerianBody& body, const EulerianState& state, const GridIndex& cell) {
  if (!body.fibre) return {};
  return body.fibre(CentreValue(body.grid, state.X, cell), state.time);
}

Mat3 ElasticGradient(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells,
                     std::size_t cell) {
  if (!body.plasticity) return cells.F[cell];
  const Vec3 X = CentreValue(body.grid, state.X, body.grid.CellAt(cell));
  return cells.F[cell] * PlasticInverse(PlasticGrid(body), state.plastic, X);
}

Mat3 CauchyStress(const EulerianBody& body, const Mat3& Fe, const FibreState& fibre) {
  const Mat3 P = std::visit([&](const auto& law) { return law.Stress(Fe, fibre); }, body.material);
  return P * Fe.transpose() / Fe.determinant();
}

void SetForces(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells, ThreadTeam& team,
               NodalForces& nodes) {
  const EulerianGrid& grid = body.grid;
  // Not set here: who writes to fresh memory first waits for it, which is better done by all threads.
  const auto of_solid = std::make_unique_for_overwrite<CellForce[]>(cells.solid.size());
  team.For(cells.solid.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) of_solid[c] = ForceOf(body, state, cells, cells.solid[c]);
  });
  std::vector<std::int32_t> solid_of(grid.cell_count(), -1);
  for (std::size_t c = 0; c < cells.solid.size(); ++c) solid_of[cells.solid[c]] = static_cast<std::int32_t>(c);
  nodes.mass.resize(grid.node_count());
  nodes.force.resize(grid.node_count());
  team.For(grid.node_count(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      nodes.mass[n] = 0;
      nodes.force[n].setZero();
      const GridIndex at = grid.NodeAt(n);
      for (int c = 0; c < 8; ++c) {
        const GridIndex cell = {at[0] - (c & 1), at[1] - (c >> 1 & 1), at[2] - (c >> 2)};
        if (!grid.HasCell(cell)) continue;
        const std::int32_t solid = solid_of[grid.CellNumber(cell)];
        if (solid < 0) continue;
        const CellForce& f = of_solid[solid];
        nodes.mass[n] += f.mass / 8;
        nodes.force[n] += f.given / 8 - f.stress * CornerGradient(c, grid.spacing);
        for (int a = 0; a < kPatterns; ++a) nodes.force[n] += CornerPattern(a, c) * f.pattern[a];
      }
    }
  });
  if (body.vertex_forces) AddVertexForces(body, state, nodes);
  SetLeaders(body, state, cells, team, nodes);
  HandToInside(team, nodes);
  const Vec3 gravity = body.gravity_scale.At(state.time) * body.gravity;
  team.For(nodes.mass.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      nodes.force[n] += nodes.mass[n] * (gravity - body.mass_damping * state.v[n]);
    }
  });
}

double ElasticEnergy(const EulerianBody& body, const EulerianState& state, const EulerianCells& cells) {
  double sum = 0;
  for (const std::size_t c : cells.solid) {
    const FibreState fibre = FibreOf(body, state, body.grid.CellAt(c));
    const Mat3 Fe = ElasticGradient(body, state, cells, c);
    const double density = std::visit([&](const auto& law) { return law.Energy(Fe, fibre); }, body.material);
    sum += density * cells.inside[c] / cells.J[c];
  }
  return sum * std::pow(body.grid.spacing, 3);
}

double KineticEnergy(const EulerianState& state, const NodalForces& nodes) {
  double sum = 0;
  for (std::size_t n = 0; n < nodes.mass.size(); ++n) {
    if (nodes.mass[n] > 0) sum += 0.5 * nodes.mass[n] * state.v[n].squaredNorm();
  }
  return sum;
}

}  // namespace fascicle
