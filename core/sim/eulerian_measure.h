#ifndef FASCICLE_CORE_SIM_EULERIAN_MEASURE_H_
#define FASCICLE_CORE_SIM_EULERIAN_MEASURE_H_

#include <vector>

#include "core/eulerian/world.h"
#include "core/scene/support_moment.h"
#include "core/sim/frame.h"

// Converts states of the eulerian method to the contents of a frame.
namespace fascicle {

// The series of a scene of the eulerian method, in the order of the values of MeasureEulerianSeries, and those that
// follow them.
std::vector<SeriesInfo> EulerianSeriesOf(const Scene& scene);
std::vector<SeriesInfo> EulerianLaterSeriesOf(const Scene& scene);

// now: the controls at the state's time. reactions: of each constraint of each body. iterations_before: those of MINRES
// up to the previous frame.
std::vector<double> MeasureEulerianSeries(const Scene& scene, const std::vector<const EulerianBody*>& bodies,
                                          const EulerianWorldState& state, const Controls& now,
                                          const std::vector<Reaction>& reactions, std::int64_t iterations_before,
                                          ThreadTeam& team);
std::vector<double> MeasureEulerianLaterSeries(const Scene& scene, const std::vector<const EulerianBody*>& bodies,
                                               const EulerianWorldState& state, const Controls& now,
                                               const std::vector<Reaction>& reactions, ThreadTeam& team);

// Positions of the surface's vertices, and the requested fields there.
BodyFrame MeasureEulerianBody(const Scene& scene, const EulerianBody& body, const EulerianState& state,
                              const BodyControls& now, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_EULERIAN_MEASURE_H_
