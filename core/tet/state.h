#ifndef FASCICLE_CORE_TET_STATE_H_
#define FASCICLE_CORE_TET_STATE_H_

#include <cstdint>

#include "core/base/archive.h"
#include "core/linalg/nodal_vector.h"

namespace fascicle {

// The stable step and when it was found. Part of the state, so that a resumed run searches at the same steps.
struct StableStep {
  double limit = 0;                // largest stable step without safety factor [s]
  std::int64_t found_at = -1;      // number of the step
  std::int64_t interval = 0;       // number of steps until the next search
  double smallest_ratio = 1;       // TetState::smallest_ratio at that step
  std::vector<double> activation;  // value of each curve at that step
};

// Everything that changes from step to step, which is what a checkpoint saves. Values of all bodies in the model's
// order.
struct TetState {
  double time = 0;  // [s]
  std::int64_t step = 0;
  NodalVector positions;   // x [m]
  NodalVector velocities;  // v [m/s]
  // Force at `positions` [N]: elastic forces, floors and rigid bodies; with explicit stepping also the viscous force of
  // the previous half step. Of kNewmark: all forces on free components, loads and damping included.
  NodalVector force;
  // For implicit and quasi-static steps: accelerations [m/s^2] (kNewmark), positions and velocities one step ago
  // (kBdf2), the pressure of each patch [Pa], and the length of the next step to try [s], 0 for the whole interval.
  NodalVector accelerations, previous_positions, previous_velocities;
  std::vector<double> pressures;
  double next_step = 0;
  std::vector<double> branches;  // of viscoelastic materials: see branches.h; empty without
  double contact_firmness = 0;   // factor on the stiffness of contacts with rigid bodies; 0 without any
  double contact_excess = 0;     // of explicit steps: largest depth relative to the allowed one
  double smallest_ratio = 1;     // least J of all elements, at most 1
  double peak_kinetic = 0;       // largest kinetic energy of the free components at any half step so far [J]
  double time_step = 0;          // of the last step [s]
  double load_work = 0;          // of loads and gravity so far, by the trapezoidal rule [J]
  double external_work = 0;      // of loads, gravity and supports so far [J]
  double activation_work = 0;    // of activation so far, in quasi-static stepping [J]
  double dissipated = 0;         // by damping so far [J]
  StableStep stable;
  std::int32_t cuts = 0;        // number of times the step is halved
  std::int64_t last_cut = 0;    // step at which `cuts` changed last
  std::int64_t iterations = 0;  // of linear solves, or of Newton's method, so far

  void Save(ArchiveWriter& archive) const;
  // Sets failed() of the archive if sizes differ from the current ones.
  void Load(ArchiveReader& archive);
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_STATE_H_
