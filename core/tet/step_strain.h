#ifndef FASCICLE_CORE_TET_STEP_STRAIN_H_
#define FASCICLE_CORE_TET_STEP_STRAIN_H_

#include "core/tet/model.h"

namespace fascicle {

// The largest logarithmic strain |ln stretch| of an element between two positions of the nodes.
struct StepStrain {
  double value = 0;
  std::size_t body = 0;
  std::int64_t element = -1;  // in the body's mesh; -1: none
};

// By the corners of each element, with valid positions `before`.
StepStrain LargestStepStrain(const TetModel& model, const NodalVector& before, const NodalVector& after);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_STEP_STRAIN_H_
