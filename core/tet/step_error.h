#ifndef FASCICLE_CORE_TET_STEP_ERROR_H_
#define FASCICLE_CORE_TET_STEP_ERROR_H_

#include "core/tet/model.h"
#include "core/tet/state.h"

// Error control of implicit steps with inertia. The leading term of a step's error in positions is
//   Newmark          |1/6 - beta| dt^2 (a' - a)   [Zienkiewicz & Xie 1991, A simple error estimator and adaptive time
//                                                  stepping procedure for dynamic analysis, EESD 20]
//   BDF2             2/9 dt^2 (a' - a)            [Hairer, Norsett & Wanner 1993, III.2]
//   backward Euler   1/2 dt^2 a'
// with the accelerations a, a' at both ends of the step.
namespace fascicle {

struct ErrorTerm {
  double factor = 0;
  bool of_change = true;  // of the change of the acceleration, or of its value at the end
  int order = 3;          // the power of dt
};

// The error of the step from `now` to `next`: its root mean square over a body's mass, relative to the diagonal of the
// body at rest; the largest of all bodies.
double ErrorOfStep(const TetModel& model, const ErrorTerm& term, const TetState& now, const TetState& next);

// The length of the next step, as a multiple of one with `error`, that is expected to have a somewhat smaller error
// than `allowed`: between a fifth and two.
double NextLength(const ErrorTerm& term, double error, double allowed);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_STEP_ERROR_H_
