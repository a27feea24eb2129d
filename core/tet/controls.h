#ifndef FASCICLE_CORE_TET_CONTROLS_H_
#define FASCICLE_CORE_TET_CONTROLS_H_

#include <vector>

#include "core/scene/rigid_motion.h"
#include "core/tet/model.h"

namespace fascicle {

// External actions on the bodies at one time.
struct TetControls {
  double time = 0;                   // [s]
  std::vector<double> activation;    // of each curve in TetModel::activations() [1]
  std::vector<double> load_scale;    // of each load [1]
  Vec3 gravity = Vec3::Zero();       // [m/s^2]
  std::vector<RigidMotion> motions;  // of each support

  // Evaluates all curves. Allocates in the first call only.
  void Set(const TetModel& model, double at_time);
};

// Sets prescribed components to their position, or velocity, at the time of the controls.
void PrescribePositions(const TetModel& model, const TetControls& controls, NodalVector& positions);
void PrescribeVelocities(const TetModel& model, const TetControls& controls, NodalVector& velocities);

// Loads and gravity on every node [N].
void ExternalForce(const TetModel& model, const TetControls& controls, ThreadTeam& team, NodalVector& force);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_CONTROLS_H_
