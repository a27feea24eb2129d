#ifndef FASCICLE_CORE_SIM_BODILESS_RUN_H_
#define FASCICLE_CORE_SIM_BODILESS_RUN_H_

#include <memory>

#include "core/sim/method_run.h"

namespace fascicle {

// The run of a scene without bodies, whose skeleton is a function of time: one step for each frame.
std::unique_ptr<MethodRun> MakeBodilessRun();

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_BODILESS_RUN_H_
