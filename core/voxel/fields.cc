#include "core/voxel/fields.h"

#include "core/materials/rotation.h"

namespace fascicle {
namespace {

SymmetricTensor SymmetricPartOf(const Mat3& A) {
  return {A(0, 0), A(1, 1), A(2, 2), 0.5 * (A(0, 1) + A(1, 0)), 0.5 * (A(1, 2) + A(2, 1)), 0.5 * (A(2, 0) + A(0, 2))};
}

SymmetricTensor StrainOf(VoxelRotation rotation, const Eigen::Matrix<double, 3, 8>& gradients,
                         const VoxelField<double>& u, const std::array<std::int32_t, 8>& nodes) {
  Mat3 grad = Mat3::Zero();  // (i, j) = du_i/dx_j
  for (int c = 0; c < 8; ++c) grad += u.At(nodes[c]) * gradients.col(c).transpose();
  if (rotation == VoxelRotation::kSmall) return SymmetricPartOf(grad);
  const Mat3 F = Mat3::Identity() + grad;
  return SymmetricPartOf(NearestRotation(F).transpose() * F - Mat3::Identity());
}

// Calls body(run, voxel, strain) for all voxels.
template <class Body>
void ForStrains(const VoxelModel& model, const VoxelField<double>& u, const Body& body) {
  const Eigen::Matrix<double, 3, 8> gradients = BrickGradients(model.mesh().spacing(), Vec3::Zero());
  for (const VoxelRun& run : model.mesh().runs()) {
    ForVoxelsOfRun(run, [&](std::int32_t voxel, const GridIndex&, const std::array<std::int32_t, 8>& nodes) {
      body(run, voxel, StrainOf(model.rotation(), gradients, u, nodes));
    });
  }
}

}  // namespace

std::vector<SymmetricTensor> StrainAtCentres(const VoxelModel& model, const VoxelField<double>& u) {
  std::vector<SymmetricTensor> strains(model.mesh().voxels());
  ForStrains(model, u, [&](const VoxelRun&, std::int32_t voxel, const SymmetricTensor& e) { strains[voxel] = e; });
  return strains;
}

std::vector<SymmetricTensor> StressAtCentres(const VoxelModel& model, const VoxelField<double>& u) {
  std::vector<SymmetricTensor> stresses(model.mesh().voxels());
  ForStrains(model, u, [&](const VoxelRun& run, std::int32_t voxel, const SymmetricTensor& e) {
    const BrickModuli<double>& moduli = model.stiffness().moduli[run.material];
    const auto scale = static_cast<double>(model.stiffness().scale[voxel]);
    const double pressure = scale * moduli.lambda * (e[0] + e[1] + e[2]);
    for (int c = 0; c < 6; ++c) stresses[voxel][c] = 2 * scale * moduli.mu * e[c] + (c < 3 ? pressure : 0);
  });
  return stresses;
}

std::vector<double> EnergyDensityAtCentres(const VoxelModel& model, const VoxelField<double>& u) {
  std::vector<double> energies(model.mesh().voxels());
  ForStrains(model, u, [&](const VoxelRun& run, std::int32_t voxel, const SymmetricTensor& e) {
    const BrickModuli<double>& moduli = model.stiffness().moduli[run.material];
    const double trace = e[0] + e[1] + e[2];
    double product = 0;
    for (int c = 0; c < 6; ++c) product += (c < 3 ? 1 : 2) * e[c] * e[c];
    energies[voxel] = static_cast<double>(model.stiffness().scale[voxel]) *
                      (moduli.mu * product + 0.5 * moduli.lambda * trace * trace);
  });
  return energies;
}

}  // namespace fascicle
