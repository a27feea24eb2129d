#include "core/voxel/equilibrium.h"

#include <algorithm>
#include <cmath>

#include "core/voxel/conjugate_gradient.h"

namespace fascicle {
namespace {

// Where only the mean of the dilatation resists, coarse levels are those of bricks whose whole dilatation does, with a
// bulk modulus that does not lock: nested levels know nothing of a mean over finer bricks. What is left of the large
// modulus is up to conjugate gradients.
constexpr double kMostLambda = 4;  // times mu; Poisson's ratio 0.4

VoxelStiffness ForMultigrid(VoxelStiffness stiffness) {
  for (BrickModuli<double>& moduli : stiffness.moduli) {
    if (moduli.lambda_out == moduli.lambda) continue;
    moduli.lambda = moduli.lambda_out = std::min(moduli.lambda, kMostLambda * moduli.mu);
  }
  return stiffness;
}

double Norm(ThreadTeam& team, const VoxelField<double>& v) { return std::sqrt(Dot(team, v, v)); }

// y += D x.
void AddShifted(ThreadTeam& team, const std::vector<double>& shift, const VoxelField<double>& x,
                VoxelField<double>& y) {
  if (shift.empty()) return;
  ForNodes(team, shift.size(), [&](std::size_t n) {
    for (int d = 0; d < 3; ++d) y.component(d)[n] += shift[n] * x.component(d)[n];
  });
}

}  // namespace

VoxelEquilibrium::VoxelEquilibrium(const VoxelModel& model, const std::vector<VoxelSupport>& supports,
                                   std::vector<double> shift, ThreadTeam& team)
    : model_(&model), team_(&team), prescribed_(model.mesh(), supports), shift_(std::move(shift)) {
  multigrid_ = std::make_unique<VoxelMultigrid>(model.mesh(), ForMultigrid(model.stiffness()), prescribed_.of_nodes(),
                                                team, shift_);
}

double VoxelEquilibrium::InternalForces(const VoxelField<double>& u, VoxelField<double>& f_int) const {
  model_->K().Apply(u, *team_, f_int);
  return 0.5 * Dot(*team_, u, f_int);
}

EquilibriumResult VoxelEquilibrium::Solve(const VoxelField<double>& f, const VoxelField<double>* b,
                                          const EquilibriumSettings& settings, VoxelField<double>& u) {
  if (!multigrid_->ok()) return {};
  return SolveLinear(f, b, settings, u);
}

EquilibriumResult VoxelEquilibrium::SolveLinear(const VoxelField<double>& f, const VoxelField<double>* b,
                                                const EquilibriumSettings& settings, VoxelField<double>& u) {
  VoxelField<double> r(u.nodes());
  model_->K().Apply(u, *team_, r);
  const double scale = Norm(*team_, f) + Norm(*team_, r);
  AddShifted(*team_, shift_, u, r);
  ForNumbers(*team_, r.size(), [&](std::size_t k) {
    r.data()[k] = f.data()[k] - r.data()[k];
    if (b != nullptr) r.data()[k] += b->data()[k];
  });
  prescribed_.Clear(r);
  const auto apply = [this](const VoxelField<double>& x, VoxelField<double>& y) {
    model_->K().Apply(x, *team_, y);
    AddShifted(*team_, shift_, x, y);
    prescribed_.Clear(y);
  };
  const VoxelCgResult cg = ConjugateGradient(*team_, apply, *multigrid_, settings.tolerance * scale,
                                             settings.max_iterations, settings.stop, r, u);
  return {cg.converged, cg.iterations, 1, scale > 0 ? cg.residual / scale : 0};
}

std::size_t VoxelEquilibrium::bytes() const {
  // u, f, and three vectors of conjugate gradients.
  return multigrid_->bytes() + 5 * 3 * VoxelField<double>::StrideOf(model_->mesh().nodes()) * sizeof(double) +
         model_->stiffness().scale.size() * sizeof(float) + model_->mesh().nodes() * sizeof(std::uint8_t) +
         shift_.size() * sizeof(double) + prescribed_.numbers().size() * sizeof(std::size_t);
}

}  // namespace fascicle
