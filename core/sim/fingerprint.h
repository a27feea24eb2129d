#ifndef FASCICLE_CORE_SIM_FINGERPRINT_H_
#define FASCICLE_CORE_SIM_FINGERPRINT_H_

#include "core/base/digest.h"
#include "core/scene/scene.h"

namespace fascicle {

// SHA-256 over everything in a scene that a simulation depends on: a checkpoint fits this scene only. Laws don't give
// their parameters away, so a material is known by its stress in a set of deformations.
Digest FingerprintOf(const Scene& scene);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_FINGERPRINT_H_
