#ifndef FASCICLE_CORE_SIM_EULERIAN_MEASURE_H_
#define FASCICLE_CORE_SIM_EULERIAN_MEASURE_H_

#include <memory>
#include <vector>

#include "core/eulerian/solver.h"
#include "core/sim/frame.h"

// Turns states of the eulerian method into what a frame carries.
namespace fascicle {

// The series of a scene of the eulerian method, in the order in which MeasureEulerianSeries gives their values.
std::vector<SeriesInfo> EulerianSeriesOf(const Scene& scene);

// iterations: of MINRES, since the frame before.
std::vector<double> MeasureEulerianSeries(const Scene& scene, const std::vector<std::unique_ptr<EulerianBody>>& bodies,
                                          const std::vector<EulerianState>& states,
                                          const std::vector<EulerianSolver>& solvers, double time_step,
                                          std::int64_t iterations, ThreadTeam& team);

// Positions of the surface's vertices, and the fields that the scene asks for there: velocities interpolated, all
// others the mean of the solid cells around a vertex.
BodyFrame MeasureEulerianBody(const Scene& scene, const EulerianBody& body, const EulerianState& state,
                              ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_EULERIAN_MEASURE_H_
