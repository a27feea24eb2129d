#ifndef FASCICLE_CORE_BASE_VON_MISES_H_
#define FASCICLE_CORE_BASE_VON_MISES_H_

#include <cmath>

#include "core/base/types.h"

namespace fascicle {

// sqrt(3/2 s : s) of the deviator s of a stress sigma [Pa].
inline double VonMises(const Mat3& sigma) {
  const Mat3 deviator = sigma - sigma.trace() / 3 * Mat3::Identity();
  return std::sqrt(1.5 * deviator.squaredNorm());
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_VON_MISES_H_
