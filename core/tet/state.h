#ifndef FASCICLE_CORE_TET_STATE_H_
#define FASCICLE_CORE_TET_STATE_H_

#include <cstdint>

#include "core/base/archive.h"
#include "core/linalg/nodal_vector.h"

namespace fascicle {

// When and for what the stable step was last found. Part of the state, so that a restored run finds it again at the
// same steps.
struct StableStep {
  double limit = 0;                // [s]; largest stable step without safety factor
  std::int64_t found_at = -1;      // step
  std::int64_t interval = 0;       // steps until it is due again
  double smallest_ratio = 1;       // TetState::smallest_ratio at that time
  std::vector<double> activation;  // of each curve at that time
};

// What changes from step to step, and all that a checkpoint saves. Values of all bodies in the model's order.
struct TetState {
  double time = 0;  // [s]
  std::int64_t step = 0;
  NodalVector positions;   // x [m]
  NodalVector velocities;  // v [m/s]
  // Force at `positions` [N]: elastic, and of floors; explicit stepping: with the viscous force of the half step
  // before.
  NodalVector force;
  // Of implicit and quasi-static steps: accelerations [m/s^2] (kNewmark), positions and velocities a step ago (kBdf2),
  // the pressure of each patch [Pa], and the length of step to try next [s], 0 when all is to be tried.
  NodalVector accelerations, previous_positions, previous_velocities;
  std::vector<double> pressures;
  double next_step = 0;
  double smallest_ratio = 1;  // least J of all elements, at most 1
  double peak_kinetic = 0;    // largest kinetic energy of the free components at a half step so far [J]
  double time_step = 0;       // of the last step [s]
  double external_work = 0;   // of loads and gravity so far [J]
  double dissipated = 0;      // by damping so far [J]
  StableStep stable;
  std::int32_t cuts = 0;        // the step is halved so many times
  std::int64_t last_cut = 0;    // step at which `cuts` last changed
  std::int64_t iterations = 0;  // of linear solves, or of Newton's method, so far

  void Save(ArchiveWriter& archive) const;
  // Sets failed() of the archive when sizes differ from the present ones.
  void Load(ArchiveReader& archive);
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_STATE_H_
