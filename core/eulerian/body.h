#ifndef FASCICLE_CORE_EULERIAN_BODY_H_
#define FASCICLE_CORE_EULERIAN_BODY_H_

#include <optional>
#include <vector>

#include "core/eulerian/fibre_samples.h"
#include "core/eulerian/grid_frame.h"
#include "core/eulerian/solid_shape.h"
#include "core/geometry/region.h"
#include "core/materials/material.h"
#include "core/scene/controls.h"

namespace fascicle {

// A solid that moves through its own grid. Const while it is stepped; everything that changes with time is in the
// controls.
struct EulerianBody {
  EulerianGrid grid;
  SolidShape shape;
  Material material;
  double density = 1060;        // rho0, at rest [kg/m^3]
  double mass_damping = 0;      // a of the force -a M v [1/s]
  Vec3 gravity = Vec3::Zero();  // at scale 1 [m/s^2]
  VolumeTreatment volume = VolumeTreatment::kPreserved;
  double stabilization = 0.05;  // eps of eps L, relative to the matrix of the volumes [1]
  std::optional<FibreSamples> fibres = std::nullopt;
  std::optional<Plasticity> plasticity = std::nullopt;
  // Whether the elastic force is evaluated at the end of the step, linearized. This makes the system larger and allows
  // longer steps.
  bool implicit_elasticity = false;
  // Whether the grid travels with the body: it moves with the rigid part of the body's motion, and the body moves
  // through it by the rest only [Fan 2013, 4.1].
  bool travels = false;
  bool maccormack = false;  // whether advection is second-order MacCormack with a limiter, in place of semi-Lagrangian
  std::optional<double> time_step = std::nullopt;  // upper bound of the step [s]
  // Parts of the material with prescribed motion, one for each of BodyControls::motions. Where two overlap, the first
  // one applies.
  std::vector<RegionPoints> supports = {};
  // For each load: the force on every vertex of the surface at scale 1 [N].
  std::vector<std::vector<Vec3>> loads = {};
  std::vector<PlaneForceField> force_fields = {};

  // The support that contains material point X; -1: none.
  int SupportOf(const Vec3& X) const {
    for (std::size_t k = 0; k < supports.size(); ++k) {
      if (supports[k].Contain(X)) return static_cast<int>(k);
    }
    return -1;
  }
  // The fibre and its activation at material point X.
  FibreState FibreAt(const Vec3& X, const BodyControls& controls) const {
    return fibres ? FibreState{fibres->At(X), controls.activations[0]} : FibreState{};
  }
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_BODY_H_
