#include "core/tet/diagnostics.h"

#include <algorithm>
#include <cmath>

#include "core/tet/branches.h"
#include "core/tet/contact.h"
#include "core/tet/floor_contact.h"
#include "core/tet/points.h"

namespace fascicle {
namespace {

// Whether velocities have no effect: neither inertia nor damping.
bool IsQuasiStatic(const TetModel& model) { return model.scene().tet.stepping == Stepping::kQuasiStatic; }

struct NodalForces {
  NodalVector elastic, viscous, external;

  NodalForces(const TetModel& model, const TetState& state, const Controls& controls, ThreadTeam& team) {
    ForceWorkspace workspace;
    FibreDrive drive{controls.activations};
    BranchDrive branches;
    if (model.branch_points() > 0) {
      SetStateDrive(model, state.branches, team, branches);
      drive.branches = &branches;
    }
    NodalVector previous;
    if (model.depends_on_rate() && state.time_step > 0) {
      previous = state.positions;
      for (std::size_t n = 0; n < previous.size(); ++n) previous[n] -= state.time_step * state.velocities[n];
      drive.previous = &previous;
      drive.inverse_step = 1 / state.time_step;
    }
    ElasticForce(model, drive, state.positions, team, workspace, elastic);
    if (IsQuasiStatic(model)) {
      viscous.assign(model.nodes(), Vec3::Zero());
    } else {
      ViscousForce(model, state.positions, state.velocities, team, workspace, viscous);
    }
    ExternalForce(model, controls, team, external);
    AddPositionLoads(model, controls.load_scales, state.positions, external);
    AddFloorForce(model, state.positions, external);
    if (!model.contact().empty()) AddContactForce(TouchesOf(model, state, controls, team), external);
  }
};

// Difference quotient from now to slightly later: at a point of a piecewise linear curve, the slope after the point
// counts.
Vec3 PrescribedAcceleration(const RigidMotion& now, const RigidMotion& later, double interval, const Vec3& X) {
  if (interval <= 0) return Vec3::Zero();
  return (later.VelocityOf(X) - now.VelocityOf(X)) / interval;
}

}  // namespace

double KineticEnergy(const TetModel& model, const NodalVector& v, ThreadTeam& team) {
  return 0.5 * SumOverNodes(team, v.size(), [&](std::size_t n) { return model.mass()[n] * v[n].squaredNorm(); });
}

VolumeRatios VolumeRatiosOf(const TetModel& model, std::size_t body_index, const NodalVector& x) {
  const TetBody& body = model.bodies()[body_index];
  VolumeRatios ratios;
  double rest = 0, present = 0;
  model.VisitElement([&]<class Element>(Element) {
    for (std::size_t e = body.tet_begin; e < body.tet_end; ++e) {
      const auto values = ValuesOf<Element>(model, e, x);
      for (int q = 0; q < Element::kPoints; ++q) {
        const double volume = Element::PointWeight(q) * Determinant(EdgeMatrix(Element::Corners(values, q))) / 6;
        const double J = volume / model.rest_volume()[Element::kPoints * e + q];
        rest += model.rest_volume()[Element::kPoints * e + q];
        present += volume;
        if ((e == body.tet_begin && q == 0) || !(J >= ratios.smallest)) ratios.smallest = J;
      }
    }
  });
  ratios.total = present / rest;
  return ratios;
}

NodalVector ReactionForces(const TetModel& model, const TetState& state, const Controls& now, const Controls& later,
                           ThreadTeam& team) {
  const NodalForces forces(model, state, now, team);
  NodalVector reactions(model.nodes(), Vec3::Zero());
  for (std::size_t s = 0; s < model.supports().size(); ++s) {
    const Support& support = model.supports()[s];
    for (std::size_t i = 0; i < support.nodes.size(); ++i) {
      const std::int32_t n = support.nodes[i];
      Vec3 inertia = Vec3::Zero();
      if (!IsQuasiStatic(model)) {
        const Vec3 acceleration =
            PrescribedAcceleration(now.motions[s], later.motions[s], state.time_step, model.rest_positions()[n]);
        inertia = model.mass()[n] * (acceleration + model.mass_damping()[n] * state.velocities[n]);
      }
      const Vec3 reaction = inertia - forces.elastic[n] - forces.viscous[n] - forces.external[n];
      for (int c = 0; c < 3; ++c) {
        if (support.owned[i][c]) reactions[n][c] = reaction[c];
      }
    }
  }
  return reactions;
}

std::vector<Reaction> Reactions(const TetModel& model, const TetState& state, const Controls& now,
                                const Controls& later, ThreadTeam& team) {
  const NodalVector forces = ReactionForces(model, state, now, later, team);
  std::vector<Reaction> reactions(model.supports().size());
  for (std::size_t s = 0; s < reactions.size(); ++s) {
    const Support& support = model.supports()[s];
    for (std::size_t i = 0; i < support.nodes.size(); ++i) {
      const std::int32_t n = support.nodes[i];
      Vec3 force = Vec3::Zero();
      for (int c = 0; c < 3; ++c) {
        if (support.owned[i][c]) force[c] = forces[n][c];
      }
      reactions[s].force += force;
      reactions[s].moment += state.positions[n].cross(force);
    }
  }
  return reactions;
}

double LargestSpeed(const NodalVector& v) {
  double largest = 0;
  for (const Vec3& velocity : v) largest = std::max(largest, velocity.squaredNorm());
  return std::sqrt(largest);
}

double EquilibriumResidual(const TetModel& model, const TetState& state, const Controls& now, ThreadTeam& team) {
  const NodalForces forces(model, state, now, team);
  double residual = 0, largest = 0;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    const Vec3 free = model.mass()[n] * model.inverse_mass()[n];
    const Vec3 sum = forces.elastic[n] + forces.viscous[n] + forces.external[n];
    residual = std::max(residual, free.cwiseProduct(sum).norm());
    largest = std::max({largest, forces.elastic[n].norm(), forces.viscous[n].norm(), forces.external[n].norm()});
  }
  return largest > 0 ? residual / largest : 0;
}

}  // namespace fascicle
