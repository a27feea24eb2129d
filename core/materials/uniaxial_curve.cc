#include "core/materials/uniaxial_curve.h"

#include <cmath>
#include <limits>
#include <optional>
#include <variant>

namespace fascicle {
namespace {

// The fibre in F = diag(l, l, stretch) at a velocity that does not depend on l: the step is so long that F hardly
// changes the rate.
FibreState FibreAt(const Contraction& contraction, double l, double stretch) {
  constexpr double kInverseStep = 1e-4;  // [1/s]
  if (contraction.velocity == 0) return {Vec3::UnitZ(), contraction.activation};
  const double isochoric = std::pow(stretch / l, 2.0 / 3.0);
  return {Vec3::UnitZ(), contraction.activation, isochoric - contraction.velocity / kInverseStep, kInverseStep};
}

// The lateral stress P_xx = P_yy of F = diag(l, l, stretch) and its derivative with respect to l.
struct Lateral {
  double stress, slope;
};

template <class Law>
Lateral LateralStress(const Law& law, const Contraction& contraction, double l, double stretch) {
  const FibreState fibre = FibreAt(contraction, l, stretch);
  const Mat3 F = Vec3(l, l, stretch).asDiagonal();
  const Mat9 tangent = law.Tangent(F, fibre);
  return {law.Stress(F, fibre)(0, 0), tangent(0, 0) + tangent(0, 4)};
}

// The zero of the lateral stress nearest to `start`, by Newton's method within a bracket.
template <class Law>
std::optional<double> FreeLateralStretch(const Law& law, const Contraction& contraction, double start, double stretch) {
  constexpr double kGrowth = 1.05;
  constexpr int kMaxWidenings = 100;  // a factor of 130 either way
  constexpr int kMaxIterations = 200;
  constexpr double kRelativeStep = 1e-14;
  double low = start, high = start;  // tension at `high`, compression at `low`
  int widenings = 0;
  while (!(LateralStress(law, contraction, low, stretch).stress <= 0)) {
    if (++widenings > kMaxWidenings) return std::nullopt;
    low /= kGrowth;
  }
  widenings = 0;
  while (!(LateralStress(law, contraction, high, stretch).stress >= 0)) {
    if (++widenings > kMaxWidenings) return std::nullopt;
    high *= kGrowth;
  }
  double l = 0.5 * (low + high);
  for (int i = 0; i < kMaxIterations; ++i) {
    const Lateral lateral = LateralStress(law, contraction, l, stretch);
    (lateral.stress < 0 ? low : high) = l;
    double next = l - lateral.stress / lateral.slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const double step = next - l;
    l = next;
    if (std::abs(step) <= kRelativeStep * l) return l;
  }
  return std::nullopt;
}

}  // namespace

UniaxialPoint UniaxialTension(const Material& material, const Contraction& contraction, double stretch) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return std::visit(
      [&](const auto& law) -> UniaxialPoint {
        const double mu = law.ShearModulus();
        const double K = law.BulkModulus();
        const double poisson_ratio = (3 * K - 2 * mu) / (2 * (3 * K + mu));
        const std::optional<double> lateral =
            FreeLateralStretch(law, contraction, std::pow(stretch, -poisson_ratio), stretch);
        if (!lateral) return {stretch, kNone, kNone, kNone, kNone, false};
        const double l = *lateral;
        const Mat3 F = Vec3(l, l, stretch).asDiagonal();
        const double nominal = law.Stress(F, FibreAt(contraction, l, stretch))(2, 2);
        return {stretch, l, l * l * stretch, nominal / (l * l), nominal, true};
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
