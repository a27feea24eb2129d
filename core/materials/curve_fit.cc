#include "core/materials/curve_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace fascicle {
namespace {

// The least-squares problem of one law and one table.
class FitProblem {
 public:
  FitProblem(const LawInfo& law, std::span<const std::size_t> free, const Contraction& contraction,
             std::span<const MeasuredPoint> points)
      : law_(law), free_(free), contraction_(contraction), points_(points) {
    for (const MeasuredPoint& point : points) largest_ = std::max(largest_, std::abs(point.nominal_stress));
  }

  // Differences to the measured stresses, as multiples of the largest of these.
  Eigen::VectorXd Differences(const std::vector<double>& values) const {
    const Material material = law_.make(values);
    Eigen::VectorXd r(static_cast<Eigen::Index>(points_.size()));
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      const MeasuredPoint& point = points_[static_cast<std::size_t>(i)];
      const double stress = UniaxialTension(material, contraction_, point.stretch).nominal_stress;
      r[i] = (stress - point.nominal_stress) / largest_;
    }
    return r;
  }

  // Derivatives of the differences by the free parameters, each in its own unit, by central differences; one-sided at
  // an end of a range.
  Eigen::MatrixXd Jacobian(const std::vector<double>& values) const {
    Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(points_.size()), static_cast<Eigen::Index>(free_.size()));
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const double step = 1e-5 * Unit(values, k);
      std::vector<double> ahead = values, behind = values;
      ahead[free_[k]] = Inside(k, values[free_[k]] + step);
      behind[free_[k]] = Inside(k, values[free_[k]] - step);
      const double change = (ahead[free_[k]] - behind[free_[k]]) / Unit(values, k);
      jacobian.col(static_cast<Eigen::Index>(k)) = (Differences(ahead) - Differences(behind)) / change;
    }
    return jacobian;
  }

  std::vector<double> Moved(std::vector<double> values, const Eigen::VectorXd& step) const {
    const std::vector<double> from = values;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      values[free_[k]] = Inside(k, values[free_[k]] + step[static_cast<Eigen::Index>(k)] * Unit(from, k));
    }
    return values;
  }

  // What a parameter's change is measured in: itself, or what is usual if it is nearly zero.
  double Unit(const std::vector<double>& values, std::size_t k) const {
    const ParameterInfo& p = law_.parameters[free_[k]];
    const double usual = std::string_view(p.unit) == "Pa" ? 1e-6 * largest_ : 1e-2;
    return std::max(std::abs(values[free_[k]]), usual);
  }

  // Whether a parameter is at an end of its range and, with that derivative of the residual, would leave it.
  bool IsBlocked(const std::vector<double>& values, std::size_t k, double derivative) const {
    const double outward = derivative > 0 ? -1 : 1, value = values[free_[k]];
    return Inside(k, outward * std::numeric_limits<double>::infinity()) == value;
  }

 private:
  // The value in the range of the parameter that is nearest to `value`.
  double Inside(std::size_t k, double value) const {
    const ParameterInfo& p = law_.parameters[free_[k]];
    const double margin = 1e-12 * (p.max - p.min);
    const double tiny = std::min(margin, std::numeric_limits<float>::min() * 1.0);
    return std::clamp(value, p.min_open ? p.min + tiny : p.min, p.max_open ? p.max - margin : p.max);
  }

  const LawInfo& law_;
  std::span<const std::size_t> free_;
  Contraction contraction_;
  std::span<const MeasuredPoint> points_;
  double largest_ = std::numeric_limits<double>::min();  // [Pa]
};

}  // namespace

CurveFit CompareWithCurve(const LawInfo& law, std::vector<double> values, const Contraction& contraction,
                          std::span<const MeasuredPoint> points) {
  CurveFit fit;
  const Material material = law.make(values);
  double sum = 0;
  for (const MeasuredPoint& point : points) {
    fit.stresses.push_back(UniaxialTension(material, contraction, point.stretch).nominal_stress);
    sum += std::pow(fit.stresses.back() - point.nominal_stress, 2);
  }
  fit.values = std::move(values);
  fit.residual = std::sqrt(sum / static_cast<double>(points.size()));
  return fit;
}

CurveFit FitToCurve(const LawInfo& law, std::vector<double> start, std::span<const std::size_t> free,
                    const Contraction& contraction, std::span<const MeasuredPoint> points) {
  constexpr int kMaxIterations = 500;
  constexpr double kSmallStep = 1e-8;
  constexpr double kMostDamping = 1e12;
  const FitProblem problem(law, free, contraction, points);
  std::vector<double> values = std::move(start);
  Eigen::VectorXd r = problem.Differences(values);
  double damping = 1e-3;
  int iterations = 0;
  bool converged = false;
  while (!converged && r.allFinite() && iterations < kMaxIterations) {
    ++iterations;
    Eigen::MatrixXd jacobian = problem.Jacobian(values);
    if (!jacobian.allFinite()) break;
    for (std::size_t k = 0; k < free.size(); ++k) {
      auto column = jacobian.col(static_cast<Eigen::Index>(k));
      if (problem.IsBlocked(values, k, column.dot(r))) column.setZero();
    }
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    const Eigen::VectorXd gradient = jacobian.transpose() * r;
    // A parameter on which no stress depends stays where it is.
    const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-15 * normal.diagonal().maxCoeff() + 1e-300);
    bool better = false;
    while (!better && damping < kMostDamping) {
      const Eigen::MatrixXd damped = normal + Eigen::MatrixXd((damping * scale).asDiagonal());
      const Eigen::VectorXd step = -damped.ldlt().solve(gradient);
      std::vector<double> moved = problem.Moved(values, step);
      const Eigen::VectorXd moved_r = problem.Differences(moved);
      better = moved_r.allFinite() && moved_r.squaredNorm() <= r.squaredNorm();
      damping = better ? std::max(damping / 10, 1e-12) : 10 * damping;
      if (!better) continue;
      double change = 0;
      for (std::size_t k = 0; k < free.size(); ++k) {
        change = std::max(change, std::abs(moved[free[k]] - values[free[k]]) / problem.Unit(values, k));
      }
      converged = change <= kSmallStep;
      values = std::move(moved);
      r = moved_r;
    }
    // No step of any length is downhill: a minimum up to round-off.
    if (!better) converged = true;
    damping = std::min(damping, 1e3);
  }
  CurveFit fit = CompareWithCurve(law, std::move(values), contraction, points);
  fit.iterations = iterations;
  fit.converged = converged;
  return fit;
}

}  // namespace fascicle
