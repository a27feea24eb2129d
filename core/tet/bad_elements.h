#ifndef FASCICLE_CORE_TET_BAD_ELEMENTS_H_
#define FASCICLE_CORE_TET_BAD_ELEMENTS_H_

#include <cstdint>
#include <vector>

#include "core/tet/forces.h"

namespace fascicle {

// Elements that a step failed at.
struct BadElements {
  std::size_t body = 0;
  std::vector<std::int64_t> elements;  // numbers in its mesh; at most 16
  bool inverted = false;               // whether J <= 0 in any of them
};

// Elements in which J <= 0 or the stress is not finite, in the first body that has any.
BadElements FindBadElements(const TetModel& model, const FibreDrive& drive, const NodalVector& x);

// The elements around a node.
BadElements FindElementsAt(const TetModel& model, std::size_t node);

// The element with the smallest height, which limits the stable step.
BadElements FindThinnestElement(const TetModel& model, const NodalVector& x);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_BAD_ELEMENTS_H_
