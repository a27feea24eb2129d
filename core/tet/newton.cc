#include "core/tet/newton.h"

#include <algorithm>
#include <cmath>

namespace fascicle {
namespace {

// Sufficient decrease [Nocedal & Wright 2006, 3.1].
constexpr double kArmijo = 1e-4;
constexpr double kShortestPart = 1.0 / 1024;
// rho of the augmented Lagrangian as part of the patch's modulus, where the Lagrangian falls without it.
constexpr double kLeastAugmentation = 0.01;

}  // namespace

NewtonSolver::NewtonSolver(const TetModel& model, ThreadTeam& team) : model_(model), team_(team), system_(model) {}

NewtonResult NewtonSolver::Solve(const IncrementalPotential& potential, const NodalVector& target,
                                 const NewtonOptions& options, NodalVector& x, std::vector<double>& pressure) {
  const VolumePatches& patches = model_.patches();
  NewtonResult result;
  pressure.resize(patches.size());
  for (;;) {
    const bool prescribed_move = FindRemaining(target, x);
    now_ = system_.Evaluate(potential, x, pressure, team_, force_);
    if (!now_.valid) {
      result.end = NewtonResult::End::kInvalid;
      return result;
    }
    const double norm = RelativeForce(result);
    if (!prescribed_move && norm <= options.tolerance && PressuresAgree(pressure, options.tolerance)) {
      result.end = NewtonResult::End::kConverged;
      return result;
    }
    if (result.iterations >= options.max_iterations) return result;
    ++result.iterations;
    if (!TakeStep(potential, NewtonSystem::Tangent::kExact, prescribed_move, x, pressure) &&
        !TakeStep(potential, NewtonSystem::Tangent::kProjected, prescribed_move, x, pressure)) {
      return result;
    }
  }
}

// One step with this tangent; false, and nothing has moved, when it has none of use.
bool NewtonSolver::TakeStep(const IncrementalPotential& potential, NewtonSystem::Tangent tangent, bool prescribed_move,
                            NodalVector& x, std::vector<double>& pressure) {
  if (!system_.Factor(potential, x, pressure, tangent, team_)) return false;
  system_.Solve(force_, remaining_, pressure, dx_, dp_);
  LookAhead(pressure);
  const double part = LineSearch(potential, x, prescribed_move);
  if (part == 0) {
    system_.Evaluate(potential, x, pressure, team_, force_);
    return false;
  }
  for (std::size_t n = 0; n < x.size(); ++n) x[n] += part * dx_[n];
  for (std::size_t n = 0; n < pressure.size(); ++n) pressure[n] += part * dp_[n];
  return true;
}

// p', theta' and the present theta of every patch.
void NewtonSolver::LookAhead(std::span<const double> pressure) {
  const VolumePatches& patches = model_.patches();
  ratio_ = system_.ratios();
  pressure_ahead_.resize(patches.size());
  ratio_ahead_.resize(patches.size());
  for (std::size_t n = 0; n < patches.size(); ++n) {
    const PatchEnergy energy{patches.modulus[n]};
    pressure_ahead_[n] = pressure[n] + dp_[n];
    ratio_ahead_[n] = ratio_[n] + (pressure_ahead_[n] - energy.Pressure(ratio_[n])) / energy.ConvexSlope(ratio_[n]);
  }
}

// sum V_n [p' theta + rho/2 (theta - theta')^2] with rho = `augmentation` k.
double NewtonSolver::PatchMerit(std::span<const double> ratio, double augmentation) const {
  const VolumePatches& patches = model_.patches();
  double merit = 0;
  for (std::size_t n = 0; n < patches.size(); ++n) {
    const double miss = ratio[n] - ratio_ahead_[n];
    merit += patches.rest_volume[n] *
             (pressure_ahead_[n] * (ratio[n] - 1) + 0.5 * augmentation * patches.modulus[n] * miss * miss);
  }
  return merit;
}

// The largest part of the step, halving it, that is valid and, once prescribed components have arrived, lowers the
// augmented Lagrangian enough; 0 when there is none.
double NewtonSolver::LineSearch(const IncrementalPotential& potential, const NodalVector& x, bool prescribed_move) {
  const VolumePatches& patches = model_.patches();
  double augmentation = 0, slope = 0;
  if (!prescribed_move) {
    // Slope of the Lagrangian, in whose force p' stands for p, and of the augmentation for rho = k.
    system_.Evaluate(potential, x, pressure_ahead_, team_, trial_force_);
    double lagrangian = 0, volume = 0;
    for (std::size_t n = 0; n < x.size(); ++n) lagrangian -= trial_force_[n].dot(dx_[n]);
    for (std::size_t n = 0; n < patches.size(); ++n) {
      const double change = ratio_ahead_[n] - ratio_[n];
      volume -= patches.rest_volume[n] * patches.modulus[n] * change * change;
    }
    for (augmentation = kLeastAugmentation; augmentation < 1 && lagrangian + augmentation * volume >= 0;) {
      augmentation *= 10;
    }
    slope = lagrangian + augmentation * volume;
    if (!(slope <= 0)) return 0;
  }
  const double merit = now_.energy + PatchMerit(ratio_, augmentation);
  for (double part = 1; part >= kShortestPart; part /= 2) {
    trial_.resize(x.size());
    for (std::size_t n = 0; n < x.size(); ++n) trial_[n] = x[n] + part * dx_[n];
    const NewtonSystem::Evaluation trial = system_.Evaluate(potential, trial_, pressure_ahead_, team_, trial_force_);
    if (!trial.valid) continue;
    if (prescribed_move) return part;
    const double trial_merit = trial.energy + PatchMerit(system_.ratios(), augmentation);
    // Below rounding nothing can be told from a difference of energies.
    const double rounding = 1e-13 * (std::abs(now_.energy) + std::abs(merit));
    if (trial_merit <= merit + kArmijo * part * slope + rounding) return part;
  }
  return 0;
}

// What is left of the way to the prescribed components; whether there is any.
bool NewtonSolver::FindRemaining(const NodalVector& target, const NodalVector& x) {
  remaining_.assign(x.size(), Vec3::Zero());
  bool any = false;
  for (std::size_t n = 0; n < x.size(); ++n) {
    for (int c = 0; c < 3; ++c) {
      if (model_.inverse_mass()[n][c] != 0) continue;
      remaining_[n][c] = target[n][c] - x[n][c];
      any |= remaining_[n][c] != 0;
    }
  }
  return any;
}

// Norm of the force on unknown components over that of all element forces.
double NewtonSolver::RelativeForce(NewtonResult& result) const {
  double squares = 0, largest = 0;
  for (std::size_t n = 0; n < force_.size(); ++n) {
    const Vec3 free = (model_.mass()[n] * model_.inverse_mass()[n]).cwiseProduct(force_[n]);
    squares += free.squaredNorm();
    if (free.norm() <= largest) continue;
    largest = free.norm();
    result.node = n;
  }
  result.residual = std::sqrt(squares) / now_.force_scale;
  return result.residual;
}

// Whether p is U'(theta), measured by the forces that the difference makes.
bool NewtonSolver::PressuresAgree(std::span<const double> pressure, double tolerance) const {
  const VolumePatches& patches = model_.patches();
  double squares = 0;
  for (std::size_t n = 0; n < patches.size(); ++n) {
    const double area = std::cbrt(patches.rest_volume[n] * patches.rest_volume[n]);
    const double miss = area * (pressure[n] - PatchEnergy{patches.modulus[n]}.Pressure(system_.ratios()[n]));
    squares += miss * miss;
  }
  return std::sqrt(squares) <= tolerance * now_.force_scale;
}

}  // namespace fascicle
