#include "core/tet/stable_step.h"

#include <cmath>
#include <limits>

namespace fascicle {
namespace {

// Residual of the eigenvalue at which Lanczos stops: half of it is the error of the step.
constexpr double kEigenvalueTolerance = 0.02;
constexpr double kHair = 1e-7;
constexpr std::size_t kGrain = 256;

}  // namespace

void TetStiffness::Set(const TetModel& model, std::span<const double> activation, const NodalVector& x,
                       ThreadTeam& team) {
  tangents_.resize(model.tetrahedra());
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const TetBody& body = model.bodies()[b];
    std::visit(
        [&](const auto& law) {
          team.For(body.tet_end - body.tet_begin, kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t e = body.tet_begin + begin; e < body.tet_begin + end; ++e) {
              const Vec3& a0 = model.fibres()[e];
              Mat3 F = EdgeMatrix(x, model.corners()[e]) * model.Dm_inverse()[e];
              // A hair longer along the fibre: where a fibre curve has a kink, at rest above all, its stiffer side
              // counts.
              F += (kHair * F * a0) * a0.transpose();
              const Mat9 tangent = law.Tangent(F, FibreState{a0, activation[b]});
              std::size_t k = 0;
              for (int i = 0; i < 9; ++i) {
                for (int j = i; j < 9; ++j) tangents_[e][k++] = static_cast<float>(tangent(i, j));
              }
            }
          });
        },
        body.source->material);
  }
}

void TetStiffness::Apply(const TetModel& model, const NodalVector& p, ThreadTeam& team, CornerForceArray& corners,
                         NodalVector& product) const {
  corners.resize(model.tetrahedra());
  team.For(model.tetrahedra(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      const Mat3 dF = EdgeMatrix(p, model.corners()[e]) * model.Dm_inverse()[e];
      Mat3 dP = Mat3::Zero();
      const float* entry = tangents_[e].data();
      for (int i = 0; i < 9; ++i) {
        double sum = *entry++ * dF.data()[i];
        for (int j = i + 1; j < 9; ++j) {
          const double h = *entry++;
          sum += h * dF.data()[j];
          dP.data()[j] += h * dF.data()[i];
        }
        dP.data()[i] += sum;
      }
      SetCornerForces(-dP, model.Dm_inverse()[e], model.rest_volume()[e], corners[e]);
    }
  });
  GatherCorners(model, corners, team, product);
}

double LargestStableStep(const TetModel& model, std::span<const double> activation, const NodalVector& x,
                         bool explicit_damping, ThreadTeam& team, CornerForceArray& corners,
                         StableStepWorkspace& workspace) {
  TetStiffness& stiffness = workspace.stiffness;
  NodalVector& inverse_root_mass = workspace.inverse_root_mass;
  LanczosWorkspace& lanczos = workspace.lanczos;
  inverse_root_mass.resize(model.nodes());
  ForNodes(team, model.nodes(), [&](std::size_t n) { inverse_root_mass[n] = model.inverse_mass()[n].cwiseSqrt(); });

  stiffness.Set(model, activation, x, team);
  const auto apply_stiffness = [&](const NodalVector& p, NodalVector& q) {
    stiffness.Apply(model, p, team, corners, q);
  };
  // NaN must come through, so no std::max.
  const double omega_squared =
      LargestEigenvalue(team, apply_stiffness, inverse_root_mass, kEigenvalueTolerance, lanczos);
  double rate = 0;  // 2 xi omega [1/s]
  if (explicit_damping && model.has_strain_damping()) {
    const auto apply_damping = [&](const NodalVector& p, NodalVector& q) {
      ViscousForce(model, x, p, team, corners, q);
      ForNodes(team, model.nodes(), [&](std::size_t n) { q[n] = -q[n]; });
    };
    rate = LargestEigenvalue(team, apply_damping, inverse_root_mass, kEigenvalueTolerance, lanczos);
  }
  if (!std::isfinite(omega_squared) || !std::isfinite(rate)) return std::numeric_limits<double>::quiet_NaN();
  // (omega dt)^2 + 2 rate dt = 4, in the form that has no difference of large numbers.
  const double stiffness_part = omega_squared > 0 ? omega_squared : 0;
  return 4 / (rate + std::sqrt(rate * rate + 4 * stiffness_part));
}

}  // namespace fascicle
