#ifndef FASCICLE_CORE_SIM_VOXEL_MEASURE_H_
#define FASCICLE_CORE_SIM_VOXEL_MEASURE_H_

#include <vector>

#include "core/sim/frame.h"
#include "core/voxel/solver.h"

// Turns a state into what a frame carries.
namespace fascicle {

// The series of a scene of the voxel method, in the order in which MeasureVoxelSeries gives their values.
std::vector<SeriesInfo> VoxelSeriesOf(const Scene& scene);

// now: the controls at the state's time. reactions: of each constraint of each body [N]. iterations_before: of the
// linear solves up to the frame before.
std::vector<double> MeasureVoxelSeries(const Scene& scene, const VoxelSolver& solver, const VoxelSceneState& state,
                                       const Controls& now, const std::vector<Vec3>& reactions,
                                       std::int64_t iterations_before);

// Positions and the fields that the scene asks for, of every body, along the axes of the world.
std::vector<BodyFrame> MeasureVoxelBodies(const Scene& scene, const VoxelSolver& solver, const VoxelSceneState& state);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_VOXEL_MEASURE_H_
