#ifndef FASCICLE_CORE_BASE_STEP_PROBLEM_H_
#define FASCICLE_CORE_BASE_STEP_PROBLEM_H_

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fascicle {

// Reasons why a step of any method fails. An element that loses much of its volume within a single step counts as
// inverted.
enum class StepProblem {
  kNone,
  kInvertedElement,
  kNotFinite,
  kNotConverged,  // the linear solve of the damping
  kUnstable,
  kStepTooSmall,
  kNoEquilibrium,      // Newton's method of implicit and quasi-static steps
  kNotSolved,          // the linear solve of voxels
  kLeftGrid,           // a body has reached the boundary of its grid
  kInaccurate,         // the error of an implicit step
  kVelocitiesNotFound  // the linear solve for volumes, supports and implicit elasticity on grids
};

// Elements at which a step failed.
struct BadElements {
  std::size_t body = 0;
  std::vector<std::int64_t> elements;  // element numbers in the body's mesh; at most 16
  bool inverted = false;               // whether J <= 0 in any of them
};

// The next step that a method proposes.
struct StepProposal {
  double time = 0;                           // its end [s]
  double dt = 0;                             // its length [s]; `time` is the current one plus dt, except for round-off
  StepProblem problem = StepProblem::kNone;  // the reason why there is none
  BadElements bad;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_STEP_PROBLEM_H_
