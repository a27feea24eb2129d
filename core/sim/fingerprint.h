#ifndef FASCICLE_CORE_SIM_FINGERPRINT_H_
#define FASCICLE_CORE_SIM_FINGERPRINT_H_

#include "core/base/digest.h"
#include "core/scene/scene.h"

namespace fascicle {

// SHA-256 over every field of a scene: a checkpoint fits this scene only. Two scenes with the same fields, in the same
// build, have the same fingerprint.
Digest FingerprintOf(const Scene& scene);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_FINGERPRINT_H_
