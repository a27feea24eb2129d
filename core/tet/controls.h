#ifndef FASCICLE_CORE_TET_CONTROLS_H_
#define FASCICLE_CORE_TET_CONTROLS_H_

#include "core/scene/controls.h"
#include "core/tet/model.h"

namespace fascicle {

// The effect of a scene's controls on the nodes of its model. Their load scales and motions correspond to
// model.loads() and model.supports().

// Sets prescribed components to their position, or velocity, at the time of the controls.
void PrescribePositions(const TetModel& model, const Controls& controls, NodalVector& positions);
void PrescribeVelocities(const TetModel& model, const Controls& controls, NodalVector& velocities);

// Loads and gravity on every node [N].
void ExternalForce(const TetModel& model, const Controls& controls, ThreadTeam& team, NodalVector& force);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_CONTROLS_H_
