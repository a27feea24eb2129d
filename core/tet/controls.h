#ifndef FASCICLE_CORE_TET_CONTROLS_H_
#define FASCICLE_CORE_TET_CONTROLS_H_

#include <Eigen/Geometry>

#include <vector>

#include "core/tet/model.h"

namespace fascicle {

// A rigid motion at one time: x = R (X - point) + point + translation.
struct RigidMotion {
  Mat3 rotation = Mat3::Identity();
  Vec3 angular_velocity = Vec3::Zero();  // [rad/s]
  Vec3 point = Vec3::Zero();             // [m]
  Vec3 translation = Vec3::Zero();       // [m]
  Vec3 velocity = Vec3::Zero();          // of the translation [m/s]

  Vec3 PositionOf(const Vec3& X) const { return rotation * (X - point) + point + translation; }
  Vec3 VelocityOf(const Vec3& X) const { return angular_velocity.cross(rotation * (X - point)) + velocity; }
};

// What acts on the bodies from outside at one time.
struct TetControls {
  double time = 0;                   // [s]
  std::vector<double> activation;    // of each curve in TetModel::activations() [1]
  std::vector<double> load_scale;    // of each load [1]
  Vec3 gravity = Vec3::Zero();       // [m/s^2]
  std::vector<RigidMotion> motions;  // of each support

  // Evaluates all curves. Allocates in the first call only.
  void Set(const TetModel& model, double at_time);
};

// Motion of one constraint at a time.
RigidMotion MotionAt(const Motion& motion, double time);

// Puts the components that supports prescribe to their place, or velocity, at the time of the controls.
void PrescribePositions(const TetModel& model, const TetControls& controls, NodalVector& positions);
void PrescribeVelocities(const TetModel& model, const TetControls& controls, NodalVector& velocities);

// Loads and gravity on every node [N].
void ExternalForce(const TetModel& model, const TetControls& controls, ThreadTeam& team, NodalVector& force);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_CONTROLS_H_
