#include "core/tet/step_error.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/geometry/bounds.h"

namespace fascicle {
namespace {

// Aims at less than the allowed error, so that few steps are repeated [Hairer, Norsett & Wanner 1993, II.4].
constexpr double kCaution = 0.8;
constexpr double kMostShrinking = 0.2, kMostGrowth = 2;

}  // namespace

double ErrorOfStep(const TetModel& model, const ErrorTerm& term, const TetState& now, const TetState& next) {
  const double scale = term.factor * next.time_step * next.time_step;
  double largest = 0;
  for (const TetBody& body : model.bodies()) {
    double squares = 0, mass = 0;
    for (std::size_t n = body.node_begin; n < body.node_end; ++n) {
      const Vec3 change = term.of_change ? Vec3(next.accelerations[n] - now.accelerations[n]) : next.accelerations[n];
      squares += model.mass()[n] * change.squaredNorm();
      mass += model.mass()[n];
    }
    const std::span<const Vec3> X(model.rest_positions());
    const double diagonal = BoundsOf(X.subspan(body.node_begin, body.node_end - body.node_begin)).extent().norm();
    largest = std::max(largest, scale * std::sqrt(squares / mass) / diagonal);
  }
  return largest;
}

double NextLength(const ErrorTerm& term, double error, double allowed) {
  if (!(error > 0)) return kMostGrowth;
  return std::clamp(kCaution * std::pow(allowed / error, 1.0 / term.order), kMostShrinking, kMostGrowth);
}

}  // namespace fascicle
