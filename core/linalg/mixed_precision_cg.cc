#include "core/linalg/mixed_precision_cg.h"

#include <cmath>

namespace fascicle {
namespace {

// Reduction of the residual for which one solve in single precision aims.
constexpr double kGain = 1e-4;
// A refinement that reduces the residual by less than this factor has failed.
constexpr double kLeastGain = 0.5;

// Sum over the nodes of all components of `term(n)`, four at a time.
template <class Term>
double Sum(ThreadTeam& team, std::size_t nodes, const Term& term) {
  return team.Sum(nodes, [&](std::size_t begin, std::size_t end) {
    Vec4f sum = Vec4f::Zero();
    for (std::size_t n = begin; n < end; ++n) sum += term(n);
    return static_cast<double>(sum.sum());
  });
}

}  // namespace

MixedPrecisionCg::Result MixedPrecisionCg::Solve(const BlockPattern& pattern, const BlockValues& values,
                                                 const NodalVector& b, double tolerance, int max_iterations,
                                                 ThreadTeam& team, NodalVector& x) {
  x.assign(b.size(), Vec3::Zero());
  Result result;
  const double start = StartFrom(b, team);
  double norm = start;
  while (norm > tolerance * start) {
    if (!Iterate(std::max(kGain, tolerance * start / norm), max_iterations, team, result)) return result;
    const double scale = norm;
    ForNodes(team, b.size(), [&](std::size_t n) { x[n] += scale * x_[n].head<3>().cast<double>(); });
    Multiply(pattern, values, x, team, residual_);
    ForNodes(team, b.size(), [&](std::size_t n) { residual_[n] = b[n] - residual_[n]; });
    const double left = StartFrom(residual_, team);
    if (!(left < kLeastGain * norm)) return result;
    norm = left;
  }
  result.converged = norm <= tolerance * start;  // false for NaN
  return result;
}

// Sets r = b / norm, z = D^-1 r, p = z and x = 0, and returns the norm, that of D^-1.
double MixedPrecisionCg::StartFrom(const NodalVector& b, ThreadTeam& team) {
  for (FloatField* field : {&x_, &r_, &z_, &p_, &q_}) field->resize(b.size());
  // The squares of small forces would underflow in single precision.
  const double largest = std::sqrt(Dot(team, b, b));
  if (!(largest > 0)) return largest;
  const double scale = 1 / largest;
  const double squares = Sum(team, b.size(), [&](std::size_t n) {
    r_[n] << (scale * b[n]).cast<float>(), 0;
    z_[n] = matrix_.inverse_diagonal(n) * r_[n];
    return Vec4f(r_[n].cwiseProduct(z_[n]));
  });
  const double norm = std::sqrt(squares);
  const auto one_over = static_cast<float>(1 / norm);
  ForNodes(team, b.size(), [&](std::size_t n) {
    r_[n] *= one_over;
    p_[n] = z_[n] *= one_over;
    x_[n].setZero();
  });
  return largest * norm;
}

// Iterates until the norm of r has fallen from 1 to `goal`. False when it does not, or when A is not positive definite.
bool MixedPrecisionCg::Iterate(double goal, int max_iterations, ThreadTeam& team, Result& result) {
  const std::size_t size = x_.size();
  for (double rz = 1; rz > goal * goal;) {
    if (result.iterations++ == max_iterations) return false;
    const double curvature = Sum(team, size, [&](std::size_t n) {
      q_[n] = matrix_.RowTimes(n, p_);
      return Vec4f(p_[n].cwiseProduct(q_[n]));
    });
    result.is_positive = !(curvature <= 0);
    const auto alpha = static_cast<float>(rz / curvature);
    if (!result.is_positive || !std::isfinite(alpha)) return false;
    const double rz_next = Sum(team, size, [&](std::size_t n) {
      x_[n] += alpha * p_[n];
      r_[n] -= alpha * q_[n];
      z_[n] = matrix_.inverse_diagonal(n) * r_[n];
      return Vec4f(r_[n].cwiseProduct(z_[n]));
    });
    const auto beta = static_cast<float>(rz_next / rz);
    rz = rz_next;
    ForNodes(team, size, [&](std::size_t n) { p_[n] = z_[n] + beta * p_[n]; });
  }
  return true;
}

}  // namespace fascicle
