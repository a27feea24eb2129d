#ifndef FASCICLE_CORE_EULERIAN_BODY_H_
#define FASCICLE_CORE_EULERIAN_BODY_H_

#include <optional>
#include <vector>

#include "core/eulerian/fibre_samples.h"
#include "core/eulerian/solid_shape.h"
#include "core/geometry/region.h"
#include "core/materials/material.h"
#include "core/scene/controls.h"

namespace fascicle {

// A solid that moves through a grid of its own. Const while it is stepped; what changes with time comes as controls.
struct EulerianBody {
  EulerianGrid grid;
  SolidShape shape;
  Material material;
  double density = 1060;        // rho0, at rest [kg/m^3]
  double mass_damping = 0;      // a of the force -a M v [1/s]
  Vec3 gravity = Vec3::Zero();  // at scale 1 [m/s^2]
  VolumeTreatment volume = VolumeTreatment::kPreserved;
  double stabilization = 0.05;  // eps of eps L, over the volume's own matrix [1]
  std::optional<FibreSamples> fibres = std::nullopt;
  std::optional<Plasticity> plasticity = std::nullopt;
  // The elastic force is taken where the step ends, linearized, which costs a larger system and allows long steps.
  bool implicit_elasticity = false;
  bool maccormack = false;  // advection of second order in time, limited, in place of semi-Lagrangian
  std::optional<double> time_step = std::nullopt;  // the longest step [s]
  // Parts of the material whose motion is prescribed, one for each of BodyControls::motions. Where two overlap, the
  // first counts.
  std::vector<RegionPoints> supports = {};
  // Of each load, the force on every vertex of the surface at scale 1 [N].
  std::vector<std::vector<Vec3>> loads = {};
  std::vector<PlaneForceField> force_fields = {};

  // The support that a point X of the material is in; -1: none.
  int SupportOf(const Vec3& X) const {
    for (std::size_t k = 0; k < supports.size(); ++k) {
      if (supports[k].Contain(X)) return static_cast<int>(k);
    }
    return -1;
  }
  // The fibre at a point X of the material, and its activation.
  FibreState FibreAt(const Vec3& X, const BodyControls& controls) const {
    return fibres ? FibreState{fibres->At(X), controls.activations[0]} : FibreState{};
  }
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_BODY_H_
