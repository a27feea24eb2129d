#include "core/eulerian/forces.h"

#include <Eigen/LU>

#include <memory>

#include "core/eulerian/elasticity.h"
#include "core/eulerian/hourglass.h"

namespace fascicle {
namespace {

// Inside nodes keep at least this part of their own mass: at edges the extrapolation of constrained nodes takes more
// than there is, and the step would be unstable.
constexpr double kLeastMass = 0.3;

// V sigma of a cell [J], its mass [kg], the force of fields on it [N], and the force of its hourglass modes on each
// corner, up to the corner's sign.
struct CellForce {
  std::array<Vec3, kHourglassModes> hourglass;
  Mat3 stress;
  double mass;
  Vec3 given;
};

// Force per deformed volume of all fields at a point of space [N/m^3].
Vec3 ForceOfFields(const EulerianBody& body, const BodyControls& controls, const Vec3& x) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < body.force_fields.size(); ++k) {
    const PlaneForceField& field = body.force_fields[k];
    const double away = (x - field.point).dot(field.normal);
    const double part = field.width > 0 ? std::clamp(away / field.width, -1.0, 1.0) : away < 0 ? -1 : 1;
    sum -= controls.force_field_scales[k] * field.force_density * part * field.normal;
  }
  return sum;
}

// The cell forces of a body with a law of one type.
template <class Law>
class CellForces {
 public:
  CellForces(const Law& law, const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
             const EulerianCells& cells)
      : law_(law),
        body_(body),
        state_(state),
        controls_(controls),
        cells_(cells),
        frame_(state.pose, body.travels),
        cell_volume_(std::pow(body.grid.spacing, 3)) {}

  CellForce Of(std::size_t cell) const {
    const Vec3 none = Vec3::Zero();
    CellForce result = {{none, none, none, none}, Mat3::Zero(), 0, none};
    if (cells_.inside[cell] == 0) return result;
    const double volume = cells_.inside[cell] * cell_volume_;
    const GridIndex at = body_.grid.CellAt(cell);
    const FibreState fibre = FibreOf(body_, state_, controls_, at);
    result.stress = volume * CauchyStress(law_, ElasticGradient(body_, state_, cells_, cell), fibre);
    SetHourglass(at, cells_.F[cell], volume, result);
    result.mass = volume * body_.density / cells_.J[cell];
    if (!body_.force_fields.empty()) {
      const Vec3 centre = frame_.PointInWorld(body_.grid.CellCentre(at));
      result.given = volume * frame_.VectorInGrid(ForceOfFields(body_, controls_, centre));
    }
    return result;
  }

 private:
  // Hourglass modes of the reference map instead of displacements: X changes by -F^-1 v dt, so the force on v is F^-T
  // times the gradient of their energy.
  void SetHourglass(const GridIndex& cell, const Mat3& F, double volume, CellForce& force) const {
    const Mat3 inverse_transpose = F.inverse().transpose();
    const double stiffness = HourglassStiffness(law_.ShearModulus(), volume, body_.grid.spacing);
    for (int mode = 0; mode < kHourglassModes; ++mode) {
      Vec3 g = Vec3::Zero();
      for (int c = 0; c < 8; ++c) g += HourglassSign(mode, c) / 8.0 * state_.X[body_.grid.Corner(cell, c)];
      force.hourglass[mode] = stiffness / 8 * inverse_transpose * g;
    }
  }

  const Law& law_;
  const EulerianBody& body_;
  const EulerianState& state_;
  const BodyControls& controls_;
  const EulerianCells& cells_;
  const GridFrame frame_;
  const double cell_volume_;
};

// Sums over the cells around each node.
void SetFromCells(const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
                  const EulerianCells& cells, ThreadTeam& team, NodalForces& nodes) {
  const EulerianGrid& grid = body.grid;
  // Left uninitialized, so that page faults are taken in parallel.
  const auto of_solid = std::make_unique_for_overwrite<CellForce[]>(cells.solid.size());
  std::visit(
      [&]<class Law>(const Law& law) {
        const CellForces<Law> forces(law, body, state, controls, cells);
        team.For(cells.solid.size(), 64, [&](std::size_t begin, std::size_t end) {
          for (std::size_t c = begin; c < end; ++c) of_solid[c] = forces.Of(cells.solid[c]);
        });
      },
      body.material);
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
        for (int mode = 0; mode < kHourglassModes; ++mode) {
          nodes.force[n] += HourglassSign(mode, c) * f.hourglass[mode];
        }
      }
    }
  });
}

// The nodes on which a force at a point acts: nodes with mass at the corners of its cell, by trilinear weights; if
// there are none, those within two cells, nearer ones with a larger weight.
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

void AddLoads(const EulerianBody& body, const EulerianState& state, const BodyControls& controls, NodalForces& nodes) {
  if (body.loads.empty()) return;
  std::vector<Vec3> forces(state.surface.size(), Vec3::Zero());
  for (std::size_t k = 0; k < body.loads.size(); ++k) {
    for (std::size_t v = 0; v < forces.size(); ++v) forces[v] += controls.load_scales[k] * body.loads[k][v];
  }
  const GridFrame frame(state.pose, body.travels);
  for (std::size_t v = 0; v < forces.size(); ++v) {
    if (forces[v].isZero(0)) continue;
    const Vec3 force = frame.VectorInGrid(forces[v]);
    for (const NodeWeight& part : NodesUnder(body.grid, nodes.mass, state.surface[v])) {
      nodes.force[part.node] += part.weight * force;
    }
  }
}

void HandToRoots(const NodeRoles& roles, ThreadTeam& team, NodalForces& nodes) {
  nodes.own_mass = nodes.mass;
  for (const NodeRoles::Constrained& constrained : roles.constrained) {
    for (const NodeWeight& root : constrained.roots) {
      nodes.mass[root.node] += root.weight * nodes.mass[constrained.node];
      nodes.force[root.node] += root.weight * nodes.force[constrained.node];
    }
    nodes.mass[constrained.node] = 0;
    nodes.force[constrained.node].setZero();
  }
  team.For(nodes.mass.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      if (roles.inside[n] != 0) nodes.mass[n] = std::max(nodes.mass[n], kLeastMass * nodes.own_mass[n]);
    }
  });
}

void AddGravityAndDamping(const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
                          ThreadTeam& team, NodalForces& nodes) {
  const Vec3 gravity = GridFrame(state.pose, body.travels).VectorInGrid(controls.gravity_scale * body.gravity);
  team.For(nodes.mass.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      nodes.force[n] += nodes.mass[n] * (gravity - body.mass_damping * state.v[n]);
    }
  });
}

}  // namespace

void SetForces(const EulerianBody& body, const EulerianState& state, const BodyControls& controls,
               const EulerianCells& cells, ThreadTeam& team, NodeRoles& roles, NodalForces& nodes) {
  SetFromCells(body, state, controls, cells, team, nodes);
  AddLoads(body, state, controls, nodes);
  SetNodeRoles(body, state, cells, nodes.mass, team, roles);
  HandToRoots(roles, team, nodes);
  AddGravityAndDamping(body, state, controls, team, nodes);
}

double KineticEnergy(const EulerianState& state, const NodalForces& nodes) {
  double sum = 0;
  for (std::size_t n = 0; n < nodes.mass.size(); ++n) {
    if (nodes.mass[n] > 0) sum += 0.5 * nodes.mass[n] * state.v[n].squaredNorm();
  }
  return sum;
}

}  // namespace fascicle
