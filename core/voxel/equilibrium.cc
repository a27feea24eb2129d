#include "core/voxel/equilibrium.h"

#include <algorithm>
#include <cmath>

#include "core/voxel/conjugate_gradient.h"

namespace fascicle {
namespace {

// Newton's method.
// Largest rotation of a brick since the levels were set up [rad] before they are set up again. Larger in dynamics,
// where systems are easier and new levels cost as much as the step.
constexpr double kMostTurned = 0.2, kMostTurnedInTime = 0.8;
constexpr double kLargestPart = 0.1;  // reduction of the residual by the conjugate gradients of one Newton step
constexpr double kSufficient = 1e-4;  // fraction of the decrease predicted by the slope [Nocedal & Wright 2006, 3.4]
constexpr double kLeastStep = 1e-4;
constexpr double kRoundingOfForces = 1e-14;
constexpr double kRounding = 1e-11;  // relative, of energies

// With mean dilatation, the multigrid levels are those of bricks with full dilatation and a bulk modulus that does not
// lock, because nested levels cannot represent the mean over finer bricks. Conjugate gradients handle the rest of a
// large bulk modulus.
constexpr double kMostLambda = 4;  // times mu; Poisson's ratio 0.4

VoxelStiffness ForMultigrid(VoxelStiffness stiffness) {
  for (BrickModuli<double>& moduli : stiffness.moduli) {
    if (moduli.lambda_out == moduli.lambda) continue;
    moduli.lambda = moduli.lambda_out = std::min(moduli.lambda, kMostLambda * moduli.mu);
  }
  return stiffness;
}

// Bodies of at most this many nodes are factored once for all time steps: a solution by the factors then costs less
// than a multigrid cycle (measured).
constexpr std::int32_t kMostFactoredInTime = 5000;

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
  if (model.rotation() == VoxelRotation::kLarge) rotated_.emplace(model.K());
  const bool factored = !rotated_ && !shift_.empty() && model.mesh().nodes() <= kMostFactoredInTime;
  multigrid_ = std::make_unique<VoxelMultigrid>(
      model.mesh(), factored ? model.stiffness() : ForMultigrid(model.stiffness()), prescribed_.of_nodes(), team,
      shift_, std::nullopt, factored ? kMostFactoredInTime : VoxelMultigrid::kMostFactored);
}

double VoxelEquilibrium::InternalForces(const VoxelField<double>& u, VoxelField<double>& f_int) {
  if (rotated_) {
    BrickRotations<double> R(model_->mesh().voxels());
    return rotated_->Forces(u, *team_, R, f_int);
  }
  model_->K().Apply(u, *team_, f_int);
  return 0.5 * Dot(*team_, u, f_int);
}

EquilibriumResult VoxelEquilibrium::Solve(const VoxelField<double>& f, const VoxelField<double>* b,
                                          const EquilibriumSettings& settings, VoxelField<double>& u) {
  if (!multigrid_->ok()) return {};
  return rotated_ ? SolveRotated(f, b, settings, u) : SolveLinear(f, b, settings, u);
}

EquilibriumResult VoxelEquilibrium::SolveLinear(const VoxelField<double>& f, const VoxelField<double>* b,
                                                const EquilibriumSettings& settings, VoxelField<double>& u) {
  VoxelField<double> r(u.nodes());
  double scale = 0;
  if (shift_.empty()) {
    VoxelField<double> held(u.nodes());
    prescribed_.Copy(u, held);
    model_->K().Apply(held, *team_, r);
    ForNumbers(*team_, r.size(), [&](std::size_t k) { r.data()[k] -= f.data()[k]; });
    prescribed_.Clear(r);
    scale = Norm(*team_, r);
  }
  model_->K().Apply(u, *team_, r);
  if (!shift_.empty()) scale = Norm(*team_, f) + Norm(*team_, r);
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
  const VoxelCgResult cg =
      ConjugateGradient(*team_, apply, *multigrid_, settings.tolerance * scale, settings.max_iterations, r, u);
  return {cg.converged, cg.iterations, 1, scale > 0 ? cg.residual / scale : 0};
}

struct VoxelEquilibrium::Place {
  Place(const VoxelModel& model, const VoxelField<double>& at) : u(at), r(at.nodes()), R(model.mesh().voxels()) {}

  VoxelField<double> u, r;   // r: f + b - D u - f_int, zero at prescribed components
  BrickRotations<double> R;  // of the bricks
  double energy = 0;         // elastic energy plus those of D and of the loads: minimal in equilibrium [J]
  double energy_size = 0;    // magnitude of its terms, for its rounding error [J]
  double forces = 0;         // |f_int| [N]
};

void VoxelEquilibrium::Visit(const VoxelField<double>& f, const VoxelField<double>* b, Place& place) {
  const double elastic = rotated_->Forces(place.u, *team_, place.R, place.r);
  place.forces = Norm(*team_, place.r);
  double work = Dot(*team_, f, place.u), of_shift = 0;
  if (b != nullptr) work += Dot(*team_, *b, place.u);
  if (!shift_.empty()) {
    of_shift = 0.5 * SumOverNodes(*team_, shift_.size(), [&](std::size_t n) {
                 return shift_[n] * place.u.At(static_cast<std::int32_t>(n)).squaredNorm();
               });
  }
  place.energy = elastic + of_shift - work;
  place.energy_size = elastic + of_shift + std::abs(work);
  AddShifted(*team_, shift_, place.u, place.r);
  ForNumbers(*team_, place.r.size(), [&](std::size_t k) {
    place.r.data()[k] = f.data()[k] - place.r.data()[k];
    if (b != nullptr) place.r.data()[k] += b->data()[k];
  });
  prescribed_.Clear(place.r);
}

bool VoxelEquilibrium::Move(const VoxelField<double>& f, const VoxelField<double>* b, const VoxelField<double>& step,
                            Place& now, Place& next) {
  const double slope = -Dot(*team_, now.r, step), size = Norm(*team_, now.r);
  for (double along = 1; along > kLeastStep; along *= 0.5) {
    ForNumbers(*team_, step.size(),
               [&](std::size_t k) { next.u.data()[k] = now.u.data()[k] + along * step.data()[k]; });
    Visit(f, b, next);
    const bool lower = next.energy <= now.energy + kSufficient * along * slope;
    // Near convergence the energies differ by less than their rounding error; then the residual decides.
    const bool same = std::abs(next.energy - now.energy) <= kRounding * now.energy_size;
    if (lower || (same && Norm(*team_, next.r) < size)) {
      std::swap(now, next);
      return true;
    }
  }
  return false;
}

// Magnitude of the terms of the bricks' forces, which cancel in rigid motions [N].
double VoxelEquilibrium::SizeOfTerms(const VoxelField<double>& u) const {
  const VoxelField<float> diagonal = DiagonalOf(model_->stiffness());
  return std::sqrt(SumOverNumbers(*team_, u.size(), [&](std::size_t k) {
    return std::pow(static_cast<double>(diagonal.data()[k]) * u.data()[k], 2);
  }));
}

EquilibriumResult VoxelEquilibrium::SolveRotated(const VoxelField<double>& f, const VoxelField<double>* b,
                                                 const EquilibriumSettings& settings, VoxelField<double>& u) {
  Place now(*model_, u), next(*model_, u);
  BrickRotations<double> of_levels(model_->mesh().voxels());
  std::unique_ptr<VoxelMultigrid> turned;  // levels of the rotated bricks
  VoxelField<double> step(u.nodes()), r(u.nodes());
  const auto apply = [&](const VoxelField<double>& x, VoxelField<double>& y) {
    rotated_->ApplyTangent(now.u, now.R, x, *team_, y);
    AddShifted(*team_, shift_, x, y);
    prescribed_.Clear(y);
  };
  EquilibriumResult result;
  const double most_turned = shift_.empty() ? kMostTurned : kMostTurnedInTime;
  const double loads = Norm(*team_, f), rounding = kRoundingOfForces * SizeOfTerms(u);
  Visit(f, b, now);
  for (;;) {
    const double size = Norm(*team_, now.r), scale = loads + now.forces;
    const double goal = std::max(settings.tolerance * scale, rounding);
    result.residual = scale > 0 ? size / scale : 0;
    result.converged = size <= goal;
    if (result.converged || !std::isfinite(size)) break;
    if (result.iterations >= settings.max_iterations) break;
    if (LargestAngle(now.R, of_levels) > most_turned) {
      of_levels = now.R;
      turned = std::make_unique<VoxelMultigrid>(model_->mesh(), ForMultigrid(model_->stiffness()),
                                                prescribed_.of_nodes(), *team_, shift_, BrickRotations<float>(now.R));
      if (!turned->ok()) break;
    }
    const double part = std::min(kLargestPart, std::sqrt(size / scale));
    std::fill(step.data(), step.data() + step.size(), 0.0);
    r = now.r;
    const VoxelCgResult cg =
        ConjugateGradient(*team_, apply, turned ? *turned : *multigrid_, std::max(0.5 * goal, part * size),
                          settings.max_iterations - result.iterations, r, step);
    result.iterations += cg.iterations;
    ++result.newton_iterations;
    if (!Move(f, b, step, now, next)) break;
  }
  u = std::move(now.u);
  return result;
}

std::size_t VoxelEquilibrium::bytes() const {
  // u, f, and three vectors of conjugate gradients.
  return multigrid_->bytes() + 5 * 3 * VoxelField<double>::StrideOf(model_->mesh().nodes()) * sizeof(double) +
         model_->stiffness().scale.size() * sizeof(float) + model_->mesh().nodes() * sizeof(std::uint8_t) +
         shift_.size() * sizeof(double) + prescribed_.numbers().size() * sizeof(std::size_t);
}

}  // namespace fascicle
