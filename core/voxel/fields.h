#ifndef FASCICLE_CORE_VOXEL_FIELDS_H_
#define FASCICLE_CORE_VOXEL_FIELDS_H_

#include <array>
#include <vector>

#include "core/voxel/model.h"

namespace fascicle {

// A symmetric tensor: components 11, 22, 33, 12, 23, 31 along the axes of the grid.
using SymmetricTensor = std::array<double, 6>;

// Strain at the centre of every voxel [1], where that of trilinear displacements is most accurate: sym(grad u), or with
// large rotation S - I of F = R S, in the rotated frame of the brick.
std::vector<SymmetricTensor> StrainAtCentres(const VoxelModel& model, const VoxelField<double>& u);

// Stress lambda tr(e) I + 2 mu e [Pa] for that strain, with each voxel's own stiffness, in the same frame.
std::vector<SymmetricTensor> StressAtCentres(const VoxelModel& model, const VoxelField<double>& u);

// Elastic energy mu e:e + lambda/2 tr(e)^2 for that strain, per volume of the voxel [J/m^3].
std::vector<double> EnergyDensityAtCentres(const VoxelModel& model, const VoxelField<double>& u);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_FIELDS_H_
