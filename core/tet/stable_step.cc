#include "core/tet/stable_step.h"

#include <cmath>
#include <limits>

#include "core/tet/floor_contact.h"
#include "core/tet/points.h"

namespace fascicle {
namespace {

// Residual of the eigenvalue at which Lanczos stops: half of it is the error of the step.
constexpr double kEigenvalueTolerance = 0.02;
constexpr double kHair = 1e-7;

}  // namespace

void TetStiffness::Set(const TetModel& model, const FibreDrive& drive, const NodalVector& x, ThreadTeam& team,
                       ForceWorkspace& workspace) {
  const VolumePatches& patches = model.patches();
  const std::size_t points = model.points_per_element() * model.tetrahedra();
  tangents_.resize(points);
  if (!patches.empty()) cofactors_.resize(points);
  slopes_.resize(patches.size());
  pressure_change_.resize(patches.size());
  UpdatePatches(model, x, team, workspace);
  for (std::size_t n = 0; n < patches.size(); ++n) {
    slopes_[n] = PatchEnergy{patches.modulus[n]}.Slope(workspace.ratio[n]);
  }
  model.VisitElement([&]<class Element>(Element) { SetElements<Element>(model, drive, x, team, workspace); });
}

template <class Element>
void TetStiffness::SetElements(const TetModel& model, const FibreDrive& drive, const NodalVector& x, ThreadTeam& team,
                               const ForceWorkspace& workspace) {
  for (const TetGroup& group : model.groups()) {
    ForElementsOfGroup(model, group, team, [&](const auto& law, std::size_t e) {
      const Vec3& a0 = model.fibres()[e];
      const auto values = ValuesOf<Element>(model, e, x);
      for (int q = 0; q < Element::kPoints; ++q) {
        const std::size_t point = Element::kPoints * e + q;
        Mat3 F = GradientAt<Element>(model, e, values, q);
        // A hair longer along the fibre: where a fibre curve has a kink, at rest above all, its stiffer side counts.
        F += (kHair * F * a0) * a0.transpose();
        Mat9 tangent = law.Tangent(F, FibreAt<Element>(model, e, drive, q));
        if (!cofactors_.empty()) {
          cofactors_[point] = Cofactor(F);
          AddCofactorTangent(PatchPressure<Element>(model.patches(), workspace.pressure, e, q), F, tangent);
        }
        std::size_t k = 0;
        for (int i = 0; i < 9; ++i) {
          for (int j = i; j < 9; ++j) tangents_[point][k++] = static_cast<float>(tangent(i, j));
        }
      }
    });
  }
}

void TetStiffness::Apply(const TetModel& model, const NodalVector& p, ThreadTeam& team, ForceWorkspace& workspace,
                         NodalVector& product) {
  workspace.element_forces.resize(model.nodes_per_element() * model.tetrahedra());
  model.VisitElement([&]<class Element>(Element) {
    ApplyToPatches<Element>(model, p, team, workspace);
    ApplyElements<Element>(model, p, team, workspace);
  });
  GatherForces(model, workspace.element_forces, team, product);
  AddFloorStiffness(model, p, product);
}

template <class Element>
void TetStiffness::ApplyToPatches(const TetModel& model, const NodalVector& p, ThreadTeam& team,
                                  ForceWorkspace& workspace) {
  const VolumePatches& patches = model.patches();
  if (patches.empty()) return;
  team.For(model.tetrahedra(), kElementGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      const auto values = ValuesOf<Element>(model, e, p);
      std::array<double, 4> changes = {};
      for (int q = 0; q < Element::kPoints; ++q) {
        const Mat3 dF = GradientAt<Element>(model, e, values, q);
        const double dJ = Contract(cofactors_[Element::kPoints * e + q], dF);
        for (int c = 0; c < 4; ++c) {
          changes[c] += model.rest_volume()[Element::kPoints * e + q] * Element::Barycentric(q, c) * dJ;
        }
      }
      workspace.corner_volume[e] = changes;
    }
  });
  GatherCornerVolumes(model, team, workspace, workspace.raw_ratio);
  patches.Smooth(workspace.raw_ratio, pressure_change_);
  for (std::size_t n = 0; n < patches.size(); ++n) workspace.raw_ratio[n] = slopes_[n] * pressure_change_[n];
  patches.Smooth(workspace.raw_ratio, pressure_change_);
}

template <class Element>
void TetStiffness::ApplyElements(const TetModel& model, const NodalVector& p, ThreadTeam& team,
                                 ForceWorkspace& workspace) const {
  team.For(model.tetrahedra(), kElementGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      const auto values = ValuesOf<Element>(model, e, p);
      std::array<Vec3, Element::kNodes> forces;
      forces.fill(Vec3::Zero());
      for (int q = 0; q < Element::kPoints; ++q) {
        const std::size_t point = Element::kPoints * e + q;
        const Mat3 dF = GradientAt<Element>(model, e, values, q);
        Mat3 dP = Mat3::Zero();
        const float* entry = tangents_[point].data();
        for (int i = 0; i < 9; ++i) {
          double sum = *entry++ * dF.data()[i];
          for (int j = i + 1; j < 9; ++j) {
            const double h = *entry++;
            sum += h * dF.data()[j];
            dP.data()[j] += h * dF.data()[i];
          }
          dP.data()[i] += sum;
        }
        if (!cofactors_.empty()) {
          dP += PatchPressure<Element>(model.patches(), pressure_change_, e, q) * cofactors_[point];
        }
        CornerValues corners;
        SetCornerForces(-dP, model.Dm_inverse()[point], model.rest_volume()[point], corners);
        Element::AddCorners(corners, q, forces);
      }
      std::copy(forces.begin(), forces.end(), &workspace.element_forces[Element::kNodes * e]);
    }
  });
}

double LargestStableStep(const TetModel& model, const FibreDrive& drive, const NodalVector& x, bool explicit_damping,
                         ThreadTeam& team, ForceWorkspace& forces, StableStepWorkspace& workspace) {
  TetStiffness& stiffness = workspace.stiffness;
  NodalVector& inverse_root_mass = workspace.inverse_root_mass;
  LanczosWorkspace& lanczos = workspace.lanczos;
  inverse_root_mass.resize(model.nodes());
  ForNodes(team, model.nodes(), [&](std::size_t n) { inverse_root_mass[n] = model.inverse_mass()[n].cwiseSqrt(); });

  stiffness.Set(model, drive, x, team, forces);
  const auto apply_stiffness = [&](const NodalVector& p, NodalVector& q) {
    stiffness.Apply(model, p, team, forces, q);
  };
  // NaN must come through, so no std::max.
  const double omega_squared =
      LargestEigenvalue(team, apply_stiffness, inverse_root_mass, kEigenvalueTolerance, lanczos);
  double rate = 0;  // 2 xi omega [1/s]
  if (explicit_damping && model.has_strain_damping()) {
    const auto apply_damping = [&](const NodalVector& p, NodalVector& q) {
      ViscousForce(model, x, p, team, forces, q);
      ForNodes(team, model.nodes(), [&](std::size_t n) { q[n] = -q[n]; });
    };
    rate = LargestEigenvalue(team, apply_damping, inverse_root_mass, kEigenvalueTolerance, lanczos);
  }
  if (!std::isfinite(omega_squared) || !std::isfinite(rate)) return std::numeric_limits<double>::quiet_NaN();
  // (omega dt)^2 + 2 rate dt = 4, in the form that has no difference of large numbers.
  const double stiffness_part = omega_squared > 0 ? omega_squared : 0;
  return 4 / (rate + std::sqrt(rate * rate + 4 * stiffness_part));
}

}  // namespace fascicle
