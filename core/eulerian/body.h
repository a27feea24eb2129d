#ifndef FASCICLE_CORE_EULERIAN_BODY_H_
#define FASCICLE_CORE_EULERIAN_BODY_H_

#include <functional>
#include <optional>
#include <vector>

#include "core/eulerian/solid_shape.h"
#include "core/materials/material.h"
#include "core/scene/scene.h"

namespace fascicle {

// A solid that moves through a grid of its own. Const while it is stepped; functions may be called from several
// threads.
struct EulerianBody {
  EulerianGrid grid;
  SolidShape shape;
  Material material;
  double density = 1060;        // rho0, at rest [kg/m^3]
  double mass_damping = 0;      // a of the force -a M v [1/s]
  Vec3 gravity = Vec3::Zero();  // [m/s^2]
  Curve gravity_scale = Curve::Constant(1);
  VolumeTreatment volume = VolumeTreatment::kPreserved;
  double stabilization = 0.05;  // eps of eps L, over the volume's own matrix [1]
  // The fibre at a point of the material, and its activation at a time [s]; null: none.
  std::function<FibreState(const Vec3& X, double time)> fibre = nullptr;
  std::optional<Plasticity> plasticity = std::nullopt;
  // The elastic force is taken where the step ends, linearized, which costs a larger system and allows long steps.
  bool implicit_elasticity = false;
  bool maccormack = false;  // advection of second order in time, limited, in place of semi-Lagrangian
  std::optional<double> time_step = std::nullopt;  // the longest step [s]
  // Which support holds a point X of the material, below `supports`; -1: it is free. Null: all are.
  std::function<int(const Vec3& X)> support_of = nullptr;
  int supports = 0;
  // The mean velocity that a support gives a point of the material from a time on for dt [s].
  std::function<Vec3(int support, const Vec3& X, double time, double dt)> support_velocity = nullptr;
  // Forces on the vertices of the surface at a time, to be set [N]; null: none.
  std::function<void(double time, std::vector<Vec3>& forces)> vertex_forces = nullptr;
  // Force per volume of the deformed body at a point of space and a time [N/m^3]; null: none.
  std::function<Vec3(const Vec3& x, double time)> force = nullptr;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_BODY_H_
