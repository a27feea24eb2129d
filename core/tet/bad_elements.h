#ifndef FASCICLE_CORE_TET_BAD_ELEMENTS_H_
#define FASCICLE_CORE_TET_BAD_ELEMENTS_H_

#include "core/base/step_problem.h"
#include "core/tet/forces.h"

namespace fascicle {

// Elements with J <= 0 or a stress that is not finite, in the first body that has any.
BadElements FindBadElements(const TetModel& model, const FibreDrive& drive, const NodalVector& x);

// The elements that contain a node.
BadElements FindElementsAt(const TetModel& model, std::size_t node);

// The element with the smallest height, which limits the stable step.
BadElements FindThinnestElement(const TetModel& model, const NodalVector& x);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_BAD_ELEMENTS_H_
