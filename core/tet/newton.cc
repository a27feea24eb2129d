#include "core/tet/newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fascicle {
namespace {

// Bounds for the tolerance of iterative linear solves. Between them it is the gain that the next step will have if
// Newton's method converges quadratically, or that of a step with a kept matrix [Eisenstat & Walker 1996, Choosing the
// forcing terms in an inexact Newton method, SIAM J. Sci. Comput. 17, choice 2].
constexpr double kMostForcing = 0.05, kLeastForcing = 0.01;
// Sufficient decrease [Nocedal & Wright 2006, 3.1].
constexpr double kArmijo = 1e-4;
constexpr double kShortestPart = 1.0 / 1024;
// The matrix is kept for the next step where a step has reduced the residual to this part. Near the solution, where
// Newton's method converges quadratically, a step with the matrix of the last point reduces it to about twice this.
constexpr double kGainOfChord = 0.1;
// A step with a kept matrix must reduce the residual to this part.
constexpr double kLeastGainOfChord = 0.5;
// Smallest part of a projection that is worth another factorization.
constexpr double kLeastProjection = 1.0 / 16;
// Smallest rho of the augmented Lagrangian, relative to the patch's modulus, where the Lagrangian falls without
// augmentation.
constexpr double kLeastAugmentation = 0.01;
// Once every J exceeds this, untangling ends at a loose force tolerance; until then, only in equilibrium.
constexpr double kUntangled = 0.3;
constexpr double kUntangledForce = 0.01;
constexpr double kUntanglingTolerance = 1e-6;
constexpr int kMaxUntangling = 200;
constexpr double kUntanglingHold = 1e-3;

// Whether every element has a positive Jacobian at its corners, too: a quadratic element may be folded there although
// its quadrature points are not. Corners of hexahedra, which may be flat at rest, are not looked at.
bool AllUpright(const TetModel& model, const NodalVector& x) {
  return std::all_of(model.corners().begin(), model.corners().end(),
                     [&](const Tetrahedron& tet) { return Determinant(EdgeMatrix(x, tet)) > 0; });
}

}  // namespace

NewtonSolver::NewtonSolver(const TetModel& model, ThreadTeam& team, Profile* profile)
    : model_(model), team_(team), system_(model, profile, team.stop()) {}

NewtonResult NewtonSolver::Solve(const IncrementalPotential& potential, const NodalVector& target,
                                 const NewtonOptions& options, NodalVector& x, std::vector<double>& pressure) {
  NewtonResult result;
  pressure.resize(model_.patches().size());
  is_evaluated_ = false;
  if (options.guess != nullptr) StartNearer(potential, *options.guess, pressure, x, pressure);
  if (options.before != nullptr) Extrapolate(potential, *options.before, options.ahead, x, pressure);
  system_.StartStep();
  const NodalVector x_start = x;
  const std::vector<double> pressure_start = pressure;
  Iterate(potential, target, options, x, pressure, result);
  // Only a factorization decides with certainty whether the matrix is that of a minimum.
  if (result.end == NewtonResult::End::kNotConverged && system_.SolveDirectly()) {
    x = x_start;
    pressure = pressure_start;
    Iterate(potential, target, options, x, pressure, result);
  }
  // The start may be tangled, or no valid part of the linear prediction exists. Retries from an untangled start, then
  // from rest.
  for (int attempt = 0; attempt < 2 && result.end == NewtonResult::End::kInvalid; ++attempt) {
    if (attempt == 1) x = model_.rest_positions();
    if (!Untangle(target, x, result)) continue;
    pressure.assign(pressure.size(), 0.0);
    Iterate(potential, target, options, x, pressure, result);
    if (attempt == 0 && result.end == NewtonResult::End::kNotConverged) result.end = NewtonResult::End::kInvalid;
  }
  result.solves = system_.solves();
  return result;
}

void NewtonSolver::Extrapolate(const IncrementalPotential& potential, const NodalVector& before, double ahead,
                               NodalVector& x, std::vector<double>& pressure) {
  NodalVector guess(x.size());
  for (std::size_t n = 0; n < x.size(); ++n) {
    // Prescribed components have their own way.
    const Vec3 free = model_.mass()[n] * model_.inverse_mass()[n];
    guess[n] = x[n] + ahead * free.cwiseProduct(x[n] - before[n]);
  }
  std::vector<double> pressure_guess = pressure;
  system_.Evaluate(potential, before, pressure, team_, force_);
  for (std::size_t n = 0; n < pressure.size(); ++n) {
    pressure_guess[n] += ahead * (pressure[n] - PatchEnergy{model_.patches().modulus[n]}.Pressure(system_.ratios()[n]));
  }
  StartNearer(potential, guess, pressure_guess, x, pressure);
}

// Replaces the start by a guess if that has a smaller force.
void NewtonSolver::StartNearer(const IncrementalPotential& potential, const NodalVector& guess,
                               const std::vector<double>& pressure_guess, NodalVector& x,
                               std::vector<double>& pressure) {
  const auto force_at = [&](const NodalVector& at, std::span<const double> with) {
    now_ = system_.Evaluate(potential, at, with, team_, force_);
    NewtonResult result;
    return now_.valid ? RelativeForce(now_, force_, result) * now_.force_scale
                      : std::numeric_limits<double>::infinity();
  };
  const double here = force_at(x, pressure);
  is_evaluated_ = force_at(guess, pressure_guess) < here;
  if (!is_evaluated_) return;
  x = guess;
  pressure = pressure_guess;
}

void NewtonSolver::Iterate(const IncrementalPotential& potential, const NodalVector& target,
                           const NewtonOptions& options, NodalVector& x, std::vector<double>& pressure,
                           NewtonResult& result) {
  result.end = NewtonResult::End::kNotConverged;
  double projection = 0, residual_before = 0;
  bool keeps_matrix = false;  // whether that of the last step suits the next one
  for (int iteration = 0;; ++iteration) {
    const bool prescribed_move = FindRemaining(target, x);
    if (!is_evaluated_) now_ = system_.Evaluate(potential, x, pressure, team_, force_);
    is_evaluated_ = false;
    if (!now_.valid) {
      result.end = NewtonResult::End::kInvalid;
      return;
    }
    const double residual = std::max(RelativeForce(now_, force_, result), PressureMiss(pressure, now_.force_scale));
    if (!prescribed_move && residual <= options.tolerance) {
      result.end = NewtonResult::End::kConverged;
      return;
    }
    if (iteration == options.max_iterations) return;
    const double gain = residual_before > 0 ? residual / residual_before : 1;
    const double useful = 0.1 * options.tolerance / residual;
    residual_before = residual;
    ++result.iterations;
    if (keeps_matrix && gain <= kGainOfChord) {
      forcing_ = std::max(useful, std::clamp(gain, kLeastForcing, kMostForcing));
      if (TakeChordStep(potential, residual, x, pressure)) continue;
    }
    forcing_ = std::max(useful, std::clamp(gain * gain, kLeastForcing, kMostForcing));
    double part = 0;
    for (bool same_point = false;; same_point = true) {
      part = TakeStep(potential, projection, same_point, prescribed_move, x, pressure);
      if (part > 0 || projection == 1) break;
      projection = std::min(1.0, std::max(kLeastProjection, 4 * projection));
    }
    keeps_matrix = part == 1 && projection == 0 && !prescribed_move;
    projection = projection > kLeastProjection ? projection / 4 : 0;
    if (part == 1) PlacePrescribed(target, x);
    if (part == 0) {
      if (prescribed_move) result.end = NewtonResult::End::kInvalid;
      return;
    }
  }
}

// Takes a whole step with the last matrix if that reduces the residual enough; otherwise leaves everything as it was.
bool NewtonSolver::TakeChordStep(const IncrementalPotential& potential, double residual, NodalVector& x,
                                 std::vector<double>& pressure) {
  if (!system_.FindChordStep(potential, pressure, forcing_, force_, team_, dx_, dp_)) return false;
  pressure_ahead_.resize(pressure.size());
  for (std::size_t n = 0; n < pressure.size(); ++n) pressure_ahead_[n] = pressure[n] + dp_[n];
  Move(x, 1);
  trial_now_ = system_.Evaluate(potential, trial_, pressure_ahead_, team_, trial_force_);
  NewtonResult trial;
  if (!trial_now_.valid ||
      !(std::max(RelativeForce(trial_now_, trial_force_, trial),
                 PressureMiss(pressure_ahead_, trial_now_.force_scale)) <= kLeastGainOfChord * residual)) {
    now_ = system_.Evaluate(potential, x, pressure, team_, force_);
    return false;
  }
  std::swap(x, trial_);
  std::swap(pressure, pressure_ahead_);
  std::swap(force_, trial_force_);
  now_ = trial_now_;
  is_evaluated_ = true;
  return true;
}

// Moves prescribed components to their targets and gives all elements positive volume by projected Newton on
// UntanglingLaw, whose energy decreases in every step. False if an element stays inverted.
bool NewtonSolver::Untangle(const NodalVector& target, NodalVector& x, NewtonResult& result) {
  IncrementalPotential potential;
  potential.untangling = true;
  const NodalVector no_load(x.size(), Vec3::Zero());
  potential.load = &no_load;
  const std::vector<double> no_pressure(model_.patches().size(), 0.0);
  // A weak spring to the start of each iteration, for bodies without supports.
  potential.inertia.assign(x.size(), 0.0);
  for (std::size_t n = 0; n < x.size(); ++n) {
    potential.inertia[n] = kUntanglingHold * std::cbrt(model_.mass()[n] / model_.bodies()[0].source->density);
  }
  PlacePrescribed(target, x);
  remaining_.assign(x.size(), Vec3::Zero());
  for (int i = 0; i < kMaxUntangling; ++i) {
    potential.inertia_centre = x;
    const NewtonSystem::Evaluation now = system_.Evaluate(potential, x, no_pressure, team_, force_);
    if (RelativeForce(now, force_, result) <
        (now.smallest_ratio >= kUntangled ? kUntangledForce : kUntanglingTolerance))
      break;
    ++result.iterations;
    if (!system_.FindStep(potential, x, no_pressure, {.projection = 1}, force_, remaining_, team_, dx_, dp_)) {
      return false;
    }
    double slope = 0;
    for (std::size_t n = 0; n < x.size(); ++n) slope -= force_[n].dot(dx_[n]);
    double part = 1;
    for (; part >= kShortestPart; part /= 2) {
      Move(x, part);
      if (system_.Evaluate(potential, trial_, no_pressure, team_, trial_force_).energy <=
          now.energy + kArmijo * part * slope) {
        break;
      }
    }
    if (part < kShortestPart) break;
    std::swap(x, trial_);
  }
  return system_.Evaluate(potential, x, no_pressure, team_, force_).smallest_ratio > 0 && AllUpright(model_, x);
}

// Takes a step with tangents projected to the given degree; returns the fraction of the step, or 0 without any motion
// if there is no acceptable one.
double NewtonSolver::TakeStep(const IncrementalPotential& potential, double projection, bool same_point,
                              bool prescribed_move, NodalVector& x, std::vector<double>& pressure) {
  const NewtonSystem::StepOptions options{.projection = projection, .tolerance = forcing_, .same_point = same_point};
  if (!system_.FindStep(potential, x, pressure, options, force_, remaining_, team_, dx_, dp_)) return 0;
  LookAhead(pressure);
  const double part = LineSearch(potential, x, prescribed_move);
  if (part == 0) {
    system_.Evaluate(potential, x, pressure, team_, force_);
    return 0;
  }
  std::swap(x, trial_);
  for (std::size_t n = 0; n < pressure.size(); ++n) pressure[n] += part * dp_[n];
  // The line search has evaluated this point already, with the pressures of a whole step.
  is_evaluated_ = !prescribed_move && (part == 1 || pressure.empty());
  if (is_evaluated_) {
    now_ = trial_now_;
    std::swap(force_, trial_force_);
  }
  return part;
}

// trial = x + part dx.
void NewtonSolver::Move(const NodalVector& x, double part) {
  trial_.resize(x.size());
  ForNodes(team_, x.size(), [&](std::size_t n) { trial_[n] = x[n] + part * dx_[n]; });
}

// Computes p', theta' and the current theta of every patch.
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

// The largest fraction of the step, found by halving, that is valid and, once prescribed components have reached their
// targets, decreases the augmented Lagrangian sufficiently; 0 if there is none.
double NewtonSolver::LineSearch(const IncrementalPotential& potential, const NodalVector& x, bool prescribed_move) {
  const VolumePatches& patches = model_.patches();
  double augmentation = 0, slope = 0;
  if (!prescribed_move) {
    // Slope of the Lagrangian, with p' in place of p in its force, and slope of the augmentation for rho = k.
    double lagrangian = system_.WorkOfPressures(dx_, dp_, team_) - Dot(team_, force_, dx_);
    double volume = 0;
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
  double step_length = 0;
  for (const Vec3& d : dx_) step_length = std::max(step_length, d.norm());
  for (double part = 1; part >= kShortestPart; part /= 2) {
    Move(x, part);
    trial_now_ = system_.Evaluate(potential, trial_, pressure_ahead_, team_, trial_force_);
    if (!trial_now_.valid) continue;
    if (prescribed_move) return part;
    const double trial_merit = trial_now_.energy + PatchMerit(system_.ratios(), augmentation);
    if (trial_merit <= merit + kArmijo * part * slope) return part;
    // Energies may be sums of much larger terms. Where rounding hides their difference, slopes decide [Hager & Zhang
    // 2005, 4.1].
    const double rounding = now_.energy_rounding + 1e-13 * (std::abs(now_.energy) + std::abs(merit)) +
                            1e-8 * now_.force_scale * step_length;
    if (trial_merit <= merit + rounding && SlopeAt(augmentation) <= (2 * kArmijo - 1) * slope) return part;
  }
  return 0;
}

// Slope of the augmented Lagrangian along dx at the trial positions.
double NewtonSolver::SlopeAt(double augmentation) const {
  const VolumePatches& patches = model_.patches();
  double slope = 0;
  for (std::size_t n = 0; n < dx_.size(); ++n) slope -= trial_force_[n].dot(dx_[n]);
  for (std::size_t n = 0; n < patches.size(); ++n) {
    slope += augmentation * patches.rest_volume[n] * patches.modulus[n] * (system_.ratios()[n] - ratio_ahead_[n]) *
             (ratio_ahead_[n] - ratio_[n]);
  }
  return slope;
}

// Computes the remaining displacement of prescribed components; returns whether there is any.
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

void NewtonSolver::PlacePrescribed(const NodalVector& target, NodalVector& x) const {
  for (std::size_t n = 0; n < x.size(); ++n) {
    for (int c = 0; c < 3; ++c) {
      if (model_.inverse_mass()[n][c] == 0) x[n][c] = target[n][c];
    }
  }
}

// Norm of the force on unknown components, as far as it exceeds its rounding error on each node, relative to that of
// all element forces.
double NewtonSolver::RelativeForce(const NewtonSystem::Evaluation& at, const NodalVector& force,
                                   NewtonResult& result) const {
  double squares = 0, largest = 0;
  for (std::size_t n = 0; n < force.size(); ++n) {
    const Vec3 free = (model_.mass()[n] * model_.inverse_mass()[n]).cwiseProduct(force[n]);
    const double excess = std::max(0.0, free.norm() - system_.force_rounding()[n]);
    squares += excess * excess;
    if (excess <= largest) continue;
    largest = excess;
    result.node = n;
  }
  result.force_scale = at.force_scale;
  result.residual = std::max(0.0, std::sqrt(squares) - at.rounding) / at.force_scale;
  return result.residual;
}

// How far p differs from U'(theta) at the last evaluated positions, measured by the forces that the difference causes.
double NewtonSolver::PressureMiss(std::span<const double> pressure, double force_scale) const {
  const VolumePatches& patches = model_.patches();
  double squares = 0;
  for (std::size_t n = 0; n < patches.size(); ++n) {
    const double area = std::cbrt(patches.rest_volume[n] * patches.rest_volume[n]);
    const double miss = area * (pressure[n] - PatchEnergy{patches.modulus[n]}.Pressure(system_.ratios()[n]));
    squares += miss * miss;
  }
  return std::sqrt(squares) / force_scale;
}

}  // namespace fascicle
