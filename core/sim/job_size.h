#ifndef FASCICLE_CORE_SIM_JOB_SIZE_H_
#define FASCICLE_CORE_SIM_JOB_SIZE_H_

#include "core/scene/scene.h"

namespace fascicle {

// How much a run needs, estimated from the sizes of the scene, before anything is allocated for it.
struct JobSize {
  double memory = 0;  // at most at any time, without the scene [byte]; within a factor of two of what was measured
  double stored = 0;  // all frames [byte]
};

// `scene` must have passed CheckScene. Cheap; thread-safe.
JobSize JobSizeOf(const Scene& scene);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_JOB_SIZE_H_
