#ifndef FASCICLE_CORE_SIM_EULERIAN_RUN_H_
#define FASCICLE_CORE_SIM_EULERIAN_RUN_H_

#include "core/sim/method_run.h"

namespace fascicle {

std::unique_ptr<MethodRun> MakeEulerianRun(const Scene& scene, ThreadTeam& team, Profile* profile);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_EULERIAN_RUN_H_
