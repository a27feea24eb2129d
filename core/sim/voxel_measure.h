#ifndef FASCICLE_CORE_SIM_VOXEL_MEASURE_H_
#define FASCICLE_CORE_SIM_VOXEL_MEASURE_H_

#include <vector>

#include "core/scene/support_moment.h"
#include "core/sim/frame.h"
#include "core/voxel/solver.h"

// Converts a state to the contents of a frame.
namespace fascicle {

// The series of a scene of the voxel method, in the order of the values of MeasureVoxelSeries, and those that follow
// them.
std::vector<SeriesInfo> VoxelSeriesOf(const Scene& scene);
std::vector<SeriesInfo> VoxelLaterSeriesOf(const Scene& scene);

// now: the controls at the state's time. reactions: of each constraint of each body. iterations_before: those of the
// linear solves up to the previous frame.
std::vector<double> MeasureVoxelSeries(const Scene& scene, const VoxelSolver& solver, const VoxelSceneState& state,
                                       const Controls& now, const std::vector<Reaction>& reactions,
                                       std::int64_t iterations_before);
std::vector<double> MeasureVoxelLaterSeries(const Scene& scene, const VoxelSolver& solver, const VoxelSceneState& state,
                                            const std::vector<Reaction>& reactions);

// A field of one body, along the world axes.
std::vector<double> VoxelValuesOf(const VoxelSolver& solver, const VoxelSceneState& state, std::size_t body,
                                  OutputField field);

// Positions and the requested fields of every body, along the world axes.
std::vector<BodyFrame> MeasureVoxelBodies(const Scene& scene, const VoxelSolver& solver, const VoxelSceneState& state);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_VOXEL_MEASURE_H_
