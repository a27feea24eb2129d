#include "core/materials/uniaxial_curve.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>

namespace fascicle {
namespace {

// The axes of a test: that of the two lateral directions and the fibre direction, in columns. A law with a reference
// direction has it along the first.
template <class Law>
Mat3 AxesOf(const Law& law) {
  if constexpr (requires { law.ReferenceDirection(); }) {
    const Vec3 reference = law.ReferenceDirection();
    if (reference != Vec3::Zero()) {
      const Vec3 fibre = reference.unitOrthogonal();
      return (Mat3() << reference, fibre.cross(reference), fibre).finished();
    }
  }
  return Mat3::Identity();
}

// A bar with stretches l along the axes.
template <class Law>
class Bar {
 public:
  Bar(const Law& law, const Contraction& contraction) : law_(law), contraction_(contraction), axes_(AxesOf(law)) {}

  // P along the axes [Pa].
  Vec3 NominalStress(const Vec3& l) const {
    return (axes_.transpose() * law_.Stress(GradientOf(l), FibreAt(l)) * axes_).diagonal();
  }
  // Derivatives of NominalStress by l [Pa].
  Mat3 Stiffness(const Vec3& l) const {
    const Mat9 tangent = law_.Tangent(GradientOf(l), FibreAt(l));
    Eigen::Matrix<double, 9, 3> directions;  // of F as one axis is stretched
    for (int a = 0; a < 3; ++a) directions.col(a) = Mat3(axes_.col(a) * axes_.col(a).transpose()).reshaped();
    return directions.transpose() * tangent * directions;
  }

 private:
  Mat3 GradientOf(const Vec3& l) const { return axes_ * l.asDiagonal() * axes_.transpose(); }
  // The fibre at a velocity that does not depend on l: the step is so long that F hardly changes the rate.
  FibreState FibreAt(const Vec3& l) const {
    constexpr double kInverseStep = 1e-4;  // [1/s]
    if (contraction_.velocity == 0) return {axes_.col(2), contraction_.activation};
    const double isochoric = l[2] / std::cbrt(l.prod());
    return {axes_.col(2), contraction_.activation, isochoric - contraction_.velocity / kInverseStep, kInverseStep};
  }

  const Law& law_;
  Contraction contraction_;
  Mat3 axes_;
};

// A stress and its derivative with respect to a stretch.
struct Lateral {
  double stress, slope;
};

// The zero nearest to `start` of lateral(l), by Newton's method within a bracket.
template <class Function>
std::optional<double> FreeStretch(const Function& lateral, double start) {
  constexpr double kGrowth = 1.05;
  constexpr int kMaxWidenings = 100;  // a factor of 130 either way
  constexpr int kMaxIterations = 200;
  constexpr double kRelativeStep = 1e-14;
  double low = start, high = start;  // tension at `high`, compression at `low`
  int widenings = 0;
  while (!(lateral(low).stress <= 0)) {
    if (++widenings > kMaxWidenings) return std::nullopt;
    low /= kGrowth;
  }
  widenings = 0;
  while (!(lateral(high).stress >= 0)) {
    if (++widenings > kMaxWidenings) return std::nullopt;
    high *= kGrowth;
  }
  double l = 0.5 * (low + high);
  for (int i = 0; i < kMaxIterations; ++i) {
    const Lateral now = lateral(l);
    (now.stress < 0 ? low : high) = l;
    double next = l - now.stress / now.slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const double step = next - l;
    l = next;
    if (std::abs(step) <= kRelativeStep * l) return l;
  }
  return std::nullopt;
}

// Half of the sum and of the difference of the lateral Kirchhoff stresses at the lateral stretches p q and p/q, and
// their derivatives with respect to the logarithms of p and q. The difference is free of the pressure, which a small
// error of p changes by a multiple of the bulk modulus.
struct LateralPair {
  template <class Law>
  LateralPair(const Bar<Law>& bar, double p, double q, double stretch) {
    const Vec3 l(p * q, p / q, stretch);
    const Vec3 P = bar.NominalStress(l);
    const Mat3 stiffness = bar.Stiffness(l);
    Eigen::Matrix2d D;  // of the Kirchhoff stresses l P by the logarithms of l
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b < 2; ++b) D(a, b) = l[b] * (l[a] * stiffness(a, b) + (a == b ? P[a] : 0));
    }
    sum = 0.5 * (l[0] * P[0] + l[1] * P[1]);
    difference = 0.5 * (l[0] * P[0] - l[1] * P[1]);
    sum_p = 0.5 * (D(0, 0) + D(0, 1) + D(1, 0) + D(1, 1));
    sum_q = 0.5 * (D(0, 0) - D(0, 1) + D(1, 0) - D(1, 1));
    difference_p = 0.5 * (D(0, 0) + D(0, 1) - D(1, 0) - D(1, 1));
    difference_q = 0.5 * (D(0, 0) - D(0, 1) - D(1, 0) + D(1, 1));
  }
  double sum, difference, sum_p, sum_q, difference_p, difference_q;
};

// The stretches with free sides of a law that narrows equally along both lateral axes.
template <class Law>
std::optional<Vec3> EqualStretches(const Bar<Law>& bar, double start, double stretch) {
  const auto lateral = [&](double l) {
    const Mat3 stiffness = bar.Stiffness({l, l, stretch});
    return Lateral{bar.NominalStress({l, l, stretch})[0], stiffness(0, 0) + stiffness(0, 1)};
  };
  const std::optional<double> l = FreeStretch(lateral, start);
  return l ? std::optional<Vec3>(Vec3(*l, *l, stretch)) : std::nullopt;
}

// The same where the lateral stretches differ: p for each q, and the q for which both stresses vanish.
template <class Law>
std::optional<Vec3> UnequalStretches(const Bar<Law>& bar, double start, double stretch) {
  const auto size_at = [&](double q) {
    const auto sum = [&](double p) {
      const LateralPair pair(bar, p, q, stretch);
      return Lateral{pair.sum, pair.sum_p / p};
    };
    return FreeStretch(sum, start).value_or(std::numeric_limits<double>::quiet_NaN());
  };
  const auto difference = [&](double q) {
    const LateralPair pair(bar, size_at(q), q, stretch);
    return Lateral{pair.difference, (pair.difference_q - pair.difference_p * pair.sum_q / pair.sum_p) / q};
  };
  const std::optional<double> q = FreeStretch(difference, 1);
  if (!q) return std::nullopt;
  const double p = size_at(*q);
  return Vec3(p * *q, p / *q, stretch);
}

}  // namespace

UniaxialPoint UniaxialTension(const Material& material, const Contraction& contraction, double stretch) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return std::visit(
      [&]<class Law>(const Law& law) -> UniaxialPoint {
        const double mu = law.ShearModulus();
        const double K = law.BulkModulus();
        const double poisson_ratio = (3 * K - 2 * mu) / (2 * (3 * K + mu));
        const Bar<Law> bar(law, contraction);
        const double start = std::pow(stretch, -poisson_ratio);
        const std::optional<Vec3> l = AxesOf(law) == Mat3::Identity() ? EqualStretches(bar, start, stretch)
                                                                      : UnequalStretches(bar, start, stretch);
        if (!l) return {stretch, kNone, kNone, kNone, kNone, kNone, false};
        const double nominal = bar.NominalStress(*l)[2];
        const double area = l->x() * l->y();
        return {stretch, l->x(), l->y(), area * stretch, nominal / area, nominal, true};
      },
      material);
}

std::vector<UniaxialPoint> UniaxialCurve(const Material& material, const Contraction& contraction,
                                         std::span<const double> stretches) {
  std::vector<UniaxialPoint> points;
  points.reserve(stretches.size());
  for (const double stretch : stretches) points.push_back(UniaxialTension(material, contraction, stretch));
  return points;
}

}  // namespace fascicle
