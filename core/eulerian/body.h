#ifndef FASCICLE_CORE_EULERIAN_BODY_H_
#define FASCICLE_CORE_EULERIAN_BODY_H_

#include <functional>

#include "core/eulerian/solid_shape.h"
#include "core/materials/material.h"

namespace fascicle {

enum class VolumeTreatment {
  kNone,            // the law's own resistance alone
  kDivergenceFree,  // div v = 0, which drifts
  kPreserved,       // div v = (1 - J)/(dt J), which does not [Fan 2013, 3.2]
};

// A solid that moves through a grid of its own. Const while it is stepped; functions may be called from several
// threads.
struct EulerianBody {
  EulerianGrid grid;
  SolidShape shape;
  Material material;
  double density = 1060;        // rho0, at rest [kg/m^3]
  double mass_damping = 0;      // a of the force -a M v [1/s]
  Vec3 gravity = Vec3::Zero();  // [m/s^2]
  VolumeTreatment volume = VolumeTreatment::kPreserved;
  double stabilization = 0.05;  // eps of eps L, over the volume's own matrix [1]
  // The fibre at a point of the material, and its activation at a time [s]; null: none.
  std::function<FibreState(const Vec3& X, double time)> fibre = nullptr;
  // Points of the material that stay where they are; null: none.
  std::function<bool(const Vec3& X)> is_held = nullptr;
  // Force per volume of the deformed body at a point of space and a time [N/m^3]; null: none.
  std::function<Vec3(const Vec3& x, double time)> force = nullptr;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_BODY_H_
