#include "core/tet/energy_correction.h"

#include <cmath>

#include "core/tet/points.h"

namespace fascicle {
namespace {

// Where F changes by less, what is lost is below rounding, and the correction fades out.
constexpr double kLeastChange = 1e-6;
// The same for the volume ratio of a patch, whose pressure then is the mean.
constexpr double kLeastRatioChange = 1e-7;

}  // namespace

// Calls visit(element, q, F, stress of law and patches, energy of the law) for every point.
template <class Element, class Visit>
void EnergyCorrection::ForPoints(const NodalVector& x, std::span<const double> activation,
                                 const ForceWorkspace& patches, ThreadTeam& team, const Visit& visit) const {
  for (const TetGroup& group : model_.groups()) {
    ForElementsOfGroup(model_, group, team, [&](const auto& law, std::size_t e) {
      const auto values = ValuesOf<Element>(model_, e, x);
      const FibreState fibre{model_.fibres()[e], model_.ActivationOf(e, activation)};
      const FibreState mean{fibre.direction, model_.ActivationOf(e, mean_)};
      for (int q = 0; q < Element::kPoints; ++q) {
        const Mat3 F = GradientAt<Element>(model_, e, values, q);
        Mat3 P = law.Stress(F, fibre);
        const double pressure = PatchPressure<Element>(model_.patches(), patches.pressure, e, q);
        if (pressure != 0) P += pressure * Cofactor(F);
        visit(e, q, F, P, law.Energy(F, mean));
      }
    });
  }
}

void EnergyCorrection::Start(const NodalVector& x, std::span<const double> activation,
                             std::span<const double> activation_next, ThreadTeam& team) {
  start_ = &x;
  next_.assign(activation_next.begin(), activation_next.end());
  mean_.resize(next_.size());
  for (std::size_t k = 0; k < mean_.size(); ++k) mean_[k] = 0.5 * (activation[k] + next_[k]);
  points_.resize(model_.elements() * static_cast<std::size_t>(model_.points_per_element()));
  UpdatePatches(model_, x, team, patches_start_);
  model_.VisitElement([&]<class Element>(Element) {
    ForPoints<Element>(x, activation, patches_start_, team,
                       [&](std::size_t e, int q, const Mat3&, const Mat3& P, double energy) {
                         points_[Element::kPoints * e + q] = {P, energy};
                       });
  });
}

void EnergyCorrection::At(const NodalVector& x, ThreadTeam& team, NodalVector& correction) {
  const VolumePatches& patches = model_.patches();
  UpdatePatches(model_, x, team, patches_end_);
  secant_.resize(patches.size());
  acting_.resize(patches.size());
  for (std::size_t n = 0; n < patches.size(); ++n) {
    const PatchEnergy energy{patches.modulus[n]};
    const double from = patches_start_.ratio[n], to = patches_end_.ratio[n];
    secant_[n] = std::abs(to - from) > kLeastRatioChange ? (energy.Value(to) - energy.Value(from)) / (to - from)
                                                         : 0.5 * (energy.Pressure(from) + energy.Pressure(to));
  }
  patches.Smooth(secant_, acting_);
  model_.VisitElement([&]<class Element>(Element) {
    element_forces_.assign(Element::kNodes * model_.elements(), Vec3::Zero());
    ForPoints<Element>(
        x, next_, patches_end_, team, [&](std::size_t e, int q, const Mat3& F, const Mat3& P, double energy) {
          const std::size_t at = Element::kPoints * e + q;
          const Mat3 F_start = GradientAt<Element>(model_, e, ValuesOf<Element>(model_, e, *start_), q);
          const Mat3 change = F - F_start;
          const double secant = PatchPressure<Element>(patches, acting_, e, q);
          const double lacking = energy - points_[at].energy + secant * (Determinant(F) - Determinant(F_start)) -
                                 0.5 * (points_[at].P + P).cwiseProduct(change).sum();
          const double c = lacking / (change.squaredNorm() + kLeastChange * kLeastChange);
          CornerValues corners;
          SetCornerForces(c * change, model_.Dm_inverse()[at], model_.rest_volume()[at], corners);
          std::array<Vec3, Element::kNodes> nodes;
          nodes.fill(Vec3::Zero());
          Element::AddCorners(corners, q, nodes);
          for (int a = 0; a < Element::kNodes; ++a) element_forces_[Element::kNodes * e + a] += nodes[a];
        });
  });
  correction.resize(model_.nodes());
  ForNodes(team, model_.nodes(), [&](std::size_t n) {
    correction[n].setZero();
    for (std::int32_t k = model_.node_use_begin()[n]; k < model_.node_use_begin()[n + 1]; ++k) {
      correction[n] += element_forces_[model_.node_uses()[k]];
    }
  });
}

}  // namespace fascicle
