#include "core/tet/forces.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace fascicle {
namespace {

// The least of all values in whatever order they come.
void TakeLeast(std::atomic<double>& least, double value) {
  double now = least.load(std::memory_order_relaxed);
  while (value < now && !least.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
  }
}

// Corner forces of one body; `v` may be null for no viscous stress.
template <bool kViscous, class Law>
ForceReport BodyForces(const Law& law, const TetModel& model, const TetBody& body, double activation,
                       const NodalVector& x, const NodalVector* v, ThreadTeam& team, CornerForceArray& corners) {
  std::atomic<bool> valid = true;
  std::atomic<double> smallest_ratio = 1;
  ForceReport report;
  report.dissipated_power = team.Sum(body.tet_end - body.tet_begin, [&](std::size_t begin, std::size_t end) {
    FibreState fibre{Vec3::Zero(), activation};
    double power = 0;
    double smallest = 1;
    bool all_valid = true;
    for (std::size_t e = body.tet_begin + begin; e < body.tet_begin + end; ++e) {
      const Tetrahedron& tet = model.corners()[e];
      const Mat3& Dm_inverse = model.Dm_inverse()[e];
      const double volume = model.rest_volume()[e];
      const Mat3 F = EdgeMatrix(x, tet) * Dm_inverse;
      fibre.direction = model.fibres()[e];
      Mat3 P = law.Stress(F, fibre);
      const double J = Determinant(F);
      smallest = std::min(smallest, J);
      all_valid &= J > 0 && std::isfinite(P.sum());
      if constexpr (kViscous) {
        const ViscousStress viscous(F, EdgeMatrix(*v, tet) * Dm_inverse, body.damping_mu, body.damping_lambda);
        P += F * viscous.S;
        power += volume * viscous.power;
      }
      SetCornerForces(P, Dm_inverse, volume, corners[e]);
    }
    TakeLeast(smallest_ratio, smallest);
    if (!all_valid) valid.store(false, std::memory_order_relaxed);
    return power;
  });
  report.valid = valid.load();
  report.smallest_ratio = smallest_ratio.load();
  return report;
}

ForceReport AllForces(const TetModel& model, std::span<const double> activation, const NodalVector& x,
                      const NodalVector* v, ThreadTeam& team, CornerForceArray& corners, NodalVector& force) {
  corners.resize(model.tetrahedra());
  ForceReport total;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const TetBody& body = model.bodies()[b];
    const bool viscous = v != nullptr && body.HasStrainDamping();
    const ForceReport report = std::visit(
        [&](const auto& law) {
          return viscous ? BodyForces<true>(law, model, body, activation[b], x, v, team, corners)
                         : BodyForces<false>(law, model, body, activation[b], x, nullptr, team, corners);
        },
        body.source->material);
    total.valid &= report.valid;
    total.dissipated_power += report.dissipated_power;
    total.smallest_ratio = std::min(total.smallest_ratio, report.smallest_ratio);
  }
  GatherCorners(model, corners, team, force);
  return total;
}

constexpr std::size_t kElementGrain = 512;

template <class Element>
void ForElements(ThreadTeam& team, const TetBody& body, const Element& element) {
  team.For(body.tet_end - body.tet_begin, kElementGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = body.tet_begin + begin; e < body.tet_begin + end; ++e) element(e);
  });
}

// What one corner of rest shape gradient g contributes to the diagonal of -D, for unit volume: twice the dissipation
// of unit velocity of that corner along each axis i, where Edot = sym(F_i x g) with F_i row i of F.
Vec3 CornerDiagonal(const Mat3& F, const Vec3& g, double mu, double lambda) {
  const Vec3 rate = F * g;  // F_i . g for each i
  Vec3 diagonal;
  for (int i = 0; i < 3; ++i) {
    diagonal[i] = mu * (F.row(i).squaredNorm() * g.squaredNorm() + rate[i] * rate[i]) + lambda * rate[i] * rate[i];
  }
  return diagonal;
}

}  // namespace

ForceReport ElasticForce(const TetModel& model, std::span<const double> activation, const NodalVector& x,
                         ThreadTeam& team, CornerForceArray& corners, NodalVector& force) {
  return AllForces(model, activation, x, nullptr, team, corners, force);
}

ForceReport ElasticAndViscousForce(const TetModel& model, std::span<const double> activation, const NodalVector& x,
                                   const NodalVector& v, ThreadTeam& team, CornerForceArray& corners,
                                   NodalVector& force) {
  return AllForces(model, activation, x, &v, team, corners, force);
}

void ViscousForce(const TetModel& model, const NodalVector& x, const NodalVector& v, ThreadTeam& team,
                  CornerForceArray& corners, NodalVector& force) {
  corners.resize(model.tetrahedra());
  for (const TetBody& body : model.bodies()) {
    const bool damped = body.HasStrainDamping();
    ForElements(team, body, [&](std::size_t e) {
      if (!damped) {
        corners[e].fill(Vec3::Zero());
        return;
      }
      const Mat3& Dm_inverse = model.Dm_inverse()[e];
      const Mat3 F = EdgeMatrix(x, model.corners()[e]) * Dm_inverse;
      const Mat3 F_rate = EdgeMatrix(v, model.corners()[e]) * Dm_inverse;
      const ViscousStress viscous(F, F_rate, body.damping_mu, body.damping_lambda);
      SetCornerForces(F * viscous.S, Dm_inverse, model.rest_volume()[e], corners[e]);
    });
  }
  GatherCorners(model, corners, team, force);
}

void ViscousDiagonal(const TetModel& model, const NodalVector& x, ThreadTeam& team, CornerForceArray& corners,
                     NodalVector& diagonal) {
  corners.resize(model.tetrahedra());
  for (const TetBody& body : model.bodies()) {
    ForElements(team, body, [&](std::size_t e) {
      const Mat3& Dm_inverse = model.Dm_inverse()[e];
      const Mat3 F = EdgeMatrix(x, model.corners()[e]) * Dm_inverse;
      const double volume = model.rest_volume()[e];
      Vec3 g0 = Vec3::Zero();
      for (int c = 0; c < 3; ++c) {
        const Vec3 g = Dm_inverse.row(c);
        g0 -= g;
        corners[e][c + 1] = volume * CornerDiagonal(F, g, body.damping_mu, body.damping_lambda);
      }
      corners[e][0] = volume * CornerDiagonal(F, g0, body.damping_mu, body.damping_lambda);
    });
  }
  GatherCorners(model, corners, team, diagonal);
}

double ElasticEnergy(const TetModel& model, std::size_t body_index, double activation, const NodalVector& x,
                     ThreadTeam& team) {
  const TetBody& body = model.bodies()[body_index];
  return std::visit(
      [&](const auto& law) {
        return team.Sum(body.tet_end - body.tet_begin, [&](std::size_t begin, std::size_t end) {
          double energy = 0;
          for (std::size_t e = body.tet_begin + begin; e < body.tet_begin + end; ++e) {
            const Mat3 F = EdgeMatrix(x, model.corners()[e]) * model.Dm_inverse()[e];
            energy += model.rest_volume()[e] * law.Energy(F, FibreState{model.fibres()[e], activation});
          }
          return energy;
        });
      },
      body.source->material);
}

void GatherCorners(const TetModel& model, const CornerForceArray& corners, ThreadTeam& team, NodalVector& sums) {
  const auto& begin = model.node_corner_begin();
  const auto& list = model.node_corners();
  sums.resize(model.nodes());
  ForNodes(team, model.nodes(), [&](std::size_t n) {
    Vec3 sum = Vec3::Zero();
    for (std::int32_t k = begin[n]; k < begin[n + 1]; ++k) sum += corners[list[k] / 4][list[k] % 4];
    sums[n] = sum;
  });
}

}  // namespace fascicle
