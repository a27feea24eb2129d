#ifndef FASCICLE_CORE_SIM_TET_MEASURE_H_
#define FASCICLE_CORE_SIM_TET_MEASURE_H_

#include <vector>

#include "core/scene/support_moment.h"
#include "core/sim/frame.h"
#include "core/tet/fields.h"
#include "core/tet/solver.h"

// Converts a state to the contents of a frame.
namespace fascicle {

// The series of a scene of the tet method, in the order of the values of MeasureSeries, and those that follow them.
std::vector<SeriesInfo> SeriesOf(const TetModel& model);
std::vector<SeriesInfo> LaterSeriesOf(const TetModel& model);

// now: the controls at the state's time. reactions: of each constraint of each body. iterations_before: those of the
// linear solves up to the previous frame.
std::vector<double> MeasureSeries(const TetModel& model, const TetState& state, const Controls& now,
                                  const std::vector<Reaction>& reactions, std::int64_t iterations_before,
                                  ThreadTeam& team);
std::vector<double> MeasureLaterSeries(const TetModel& model, const TetState& state, const Controls& now,
                                       const std::vector<Reaction>& reactions, ThreadTeam& team);

// The mid-edge nodes of each body; empty unless elements are quadratic.
std::vector<HigherOrderNodes> HigherOrderNodesOf(const TetModel& model);

// Positions and the requested fields of every body.
std::vector<BodyFrame> MeasureBodies(const TetModel& model, const TetState& state, const StateControls& controls,
                                     ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_TET_MEASURE_H_
