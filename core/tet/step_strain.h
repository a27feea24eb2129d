#ifndef FASCICLE_CORE_TET_STEP_STRAIN_H_
#define FASCICLE_CORE_TET_STEP_STRAIN_H_

#include "core/tet/model.h"

namespace fascicle {

// The logarithmic strain |ln stretch| between two positions of the nodes that 1 % of a body's volume exceeds, and the
// element where it is reached. The few elements at the rim of a support do not count: their strain grows without bound
// as the mesh is refined.
struct StepStrain {
  double value = 0;
  std::size_t body = 0;
  std::int64_t element = -1;  // in the body's mesh; -1: none
};

// Of the body in which it is largest. By the edges of each element (MeanEdges), with valid positions `before`.
StepStrain LargestStepStrain(const TetModel& model, const NodalVector& before, const NodalVector& after);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_STEP_STRAIN_H_
