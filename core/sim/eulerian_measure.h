#ifndef FASCICLE_CORE_SIM_EULERIAN_MEASURE_H_
#define FASCICLE_CORE_SIM_EULERIAN_MEASURE_H_

#include <vector>

#include "core/eulerian/world.h"
#include "core/sim/frame.h"

// Turns states of the eulerian method into what a frame carries.
namespace fascicle {

// The series of a scene of the eulerian method, in the order in which MeasureEulerianSeries gives their values.
std::vector<SeriesInfo> EulerianSeriesOf(const Scene& scene);

// now: the controls at the state's time. reactions: of each constraint of each body [N]. iterations_before: of MINRES
// up to the frame before.
std::vector<double> MeasureEulerianSeries(const Scene& scene, const std::vector<const EulerianBody*>& bodies,
                                          const EulerianWorldState& state, const Controls& now,
                                          const std::vector<Vec3>& reactions, std::int64_t iterations_before,
                                          ThreadTeam& team);

// Positions of the surface's vertices, and the fields that the scene asks for there.
BodyFrame MeasureEulerianBody(const Scene& scene, const EulerianBody& body, const EulerianState& state,
                              const BodyControls& now, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_EULERIAN_MEASURE_H_
