#ifndef FASCICLE_CORE_BASE_STEP_PROBLEM_H_
#define FASCICLE_CORE_BASE_STEP_PROBLEM_H_

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fascicle {

// What can go wrong with a step of any method. An element counts as inverted also when it loses much of its volume in a
// single step.
enum class StepProblem {
  kNone,
  kInvertedElement,
  kNotFinite,
  kNotConverged,  // the linear solve of the damping
  kUnstable,
  kStepTooSmall,
  kNoEquilibrium,       // Newton's method of implicit and quasi-static steps
  kNotSolved,           // the linear solve of voxels
  kLeftGrid,            // a body has come to the side of its grid
  kVelocitiesNotFound,  // the linear solve of volumes, supports and implicit elasticity on grids
  kStopped              // as asked
};

// Elements that a step failed at.
struct BadElements {
  std::size_t body = 0;
  std::vector<std::int64_t> elements;  // numbers in its mesh; at most 16
  bool inverted = false;               // whether J <= 0 in any of them
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_STEP_PROBLEM_H_
