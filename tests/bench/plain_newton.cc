#include "plain_newton.h"

#include <algorithm>
#include <cmath>

namespace fascicle::bench {
namespace {

constexpr int kMostIterations = 50;
constexpr double kShortestPart = 1.0 / 1024;
constexpr double kLeastProjection = 1.0 / 16;
constexpr double kSufficient = 1e-4;  // Armijo

}  // namespace

PlainNewton::PlainNewton(const TetModel& model)
    : model_(model), matrix_(model), solver_(matrix_), x_(model.InitialPositions()) {}

bool PlainNewton::Run(double from, double to, int steps, double tolerance) {
  for (int step = 1; step <= steps; ++step) {
    if (!Equilibrate(from + (to - from) * step / steps, tolerance)) return false;
  }
  return true;
}

bool PlainNewton::Equilibrate(double activation, double tolerance) {
  const std::array<double, 1> activations = {activation};
  const FibreDrive drive(activations);
  for (int i = 0; i < kMostIterations; ++i) {
    if (!ElasticForce(model_, drive, x_, team_, workspace_, force_).valid) return false;
    // Element forces of the previous iteration, which differ little near convergence.
    if (i > 0 && NormOfFreeForce() <= tolerance * matrix_.element_force_norm()) return true;
    ++iterations_;
    if (!Factor(drive)) return false;
    if (!Search(drive, solver_.Solve(matrix_.ToComponents(force_)))) return false;
  }
  return false;
}

// With the exact tangent if it is positive definite, otherwise with a partly projected one. The next iteration starts
// with a quarter of the fraction that this one needed, as the core does.
bool PlainNewton::Factor(const FibreDrive& drive) {
  projection_ = projection_ > kLeastProjection ? projection_ / 4 : 0;
  for (;;) {
    matrix_.Assemble(drive, x_, {.projection = projection_}, team_);
    ++factorizations_;
    if (solver_.Factor()) return true;
    if (projection_ == 1) return false;
    projection_ = std::min(1.0, std::max(kLeastProjection, 4 * projection_));
  }
}

// Takes the largest fraction of the step that lowers the energy.
bool PlainNewton::Search(const FibreDrive& drive, const std::vector<double>& step) {
  const std::vector<double> force = matrix_.ToComponents(force_);
  double slope = 0;
  for (std::size_t k = 0; k < step.size(); ++k) slope -= force[k] * step[k];
  const double energy = EnergyAt(drive, x_);
  const double rounding = 1e-12 * std::abs(energy);
  for (double part = 1; part >= kShortestPart; part /= 2) {
    trial_ = x_;
    matrix_.AddComponents(step, part, trial_);
    if (EnergyAt(drive, trial_) <= energy + kSufficient * part * slope + rounding) {
      std::swap(x_, trial_);
      return true;
    }
  }
  return false;
}

// Infinite where an element is inverted.
double PlainNewton::EnergyAt(const FibreDrive& drive, const NodalVector& x) {
  const double energy = ElasticEnergy(model_, 0, drive, x, team_);
  return std::isfinite(energy) ? energy : INFINITY;
}

double PlainNewton::NormOfFreeForce() const {
  double squares = 0;
  for (const double f : matrix_.ToComponents(force_)) squares += f * f;
  return std::sqrt(squares);
}

}  // namespace fascicle::bench
