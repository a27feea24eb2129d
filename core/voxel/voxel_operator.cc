#include "core/voxel/voxel_operator.h"

#include <algorithm>

#include "core/base/check.h"

namespace fascicle {
namespace {

std::vector<BrickModuli<double>> ModuliOfAll(const std::vector<VoxelMaterial>& materials, Dilatation dilatation) {
  std::vector<BrickModuli<double>> moduli(1, BrickModuli<double>{0, 0, 0});
  for (const VoxelMaterial& material : materials) moduli.push_back(ModuliOf(material, dilatation));
  return moduli;
}

}  // namespace

VoxelStiffness::VoxelStiffness(const VoxelMesh& m, std::vector<BrickModuli<double>> moduli_of_materials)
    : mesh(&m), moduli(std::move(moduli_of_materials)), scale(m.voxels(), 1.0f) {
  for (const VoxelRun& run : m.runs()) {
    FASCICLE_CHECK(run.material < static_cast<std::int32_t>(moduli.size()), "every voxel has a material");
  }
  scale.resize(m.voxels() + VoxelField<float>::kPadding, 0.0f);
}

VoxelStiffness::VoxelStiffness(const VoxelMesh& m, const std::vector<VoxelMaterial>& materials, Dilatation dilatation,
                               const std::vector<float>& scale_of_voxels)
    : VoxelStiffness(m, ModuliOfAll(materials, dilatation)) {
  if (scale_of_voxels.empty()) return;
  FASCICLE_CHECK(scale_of_voxels.size() == static_cast<std::size_t>(m.voxels()), "one factor for each voxel");
  std::copy(scale_of_voxels.begin(), scale_of_voxels.end(), scale.begin());
}

std::vector<float> StiffnessOfVoxels(const VoxelGrid& grid) {
  std::vector<float> scale;
  if (grid.stiffness.empty()) return scale;
  for (std::size_t v = 0; v < grid.voxels(); ++v) {
    if (grid.material[v] != 0) scale.push_back(grid.stiffness[v]);
  }
  return scale;
}

template <class S>
VoxelOperator<S>::VoxelOperator(const VoxelStiffness& stiffness, const VoxelKernels* kernels)
    : stiffness_(&stiffness), kernels_(kernels), shape_(ShapeOf<S>(stiffness.mesh->spacing())) {
  for (const BrickModuli<double>& m : stiffness.moduli) {
    moduli_.push_back({static_cast<S>(m.lambda), static_cast<S>(m.lambda_out), static_cast<S>(m.mu)});
  }
}

template <class S>
void VoxelOperator<S>::Apply(const VoxelField<S>& x, ThreadTeam& team, VoxelField<S>& y) const {
  FASCICLE_CHECK(x.nodes() == mesh().nodes() && y.nodes() == mesh().nodes() && x.data() != y.data(),
                 "fields of this mesh");
  ForSlabs(mesh(), team, [&](std::size_t s) { ApplySlab(s, x, y); });
}

template <class S>
ProductTask<S> VoxelOperator<S>::TaskOf(std::size_t s, const VoxelField<S>& x, VoxelField<S>& y) const {
  const VoxelSlab& slab = mesh().slabs()[s];
  ProductTask<S> task;
  task.runs = mesh().runs().data() + slab.first_run;
  task.run_count = slab.end_run - slab.first_run;
  task.scale = stiffness_->scale.data();
  task.moduli = moduli_.data();
  task.shape = &shape_;
  for (int d = 0; d < 3; ++d) {
    task.x[d] = x.component(d);
    task.y[d] = y.component(d);
  }
  task.end_node = slab.end_node;
  return task;
}

template <class S>
void VoxelOperator<S>::ApplySlab(std::size_t s, const VoxelField<S>& x, VoxelField<S>& y) const {
  ClearSlab(mesh(), s, y);
  const ProductTask<S> task = TaskOf(s, x, y);
  if constexpr (std::is_same_v<S, double>) {
    kernels_->product(task);
  } else {
    kernels_->product_float(task);
  }
}

template class VoxelOperator<double>;
template class VoxelOperator<float>;

VoxelField<float> DiagonalOf(const VoxelStiffness& stiffness) {
  const VoxelMesh& mesh = *stiffness.mesh;
  VoxelField<float> diagonal(mesh.nodes());
  std::vector<Vec3> of_material;
  for (const BrickModuli<double>& moduli : stiffness.moduli)
    of_material.push_back(BrickDiagonal(mesh.spacing(), moduli));
  for (const VoxelRun& run : mesh.runs()) {
    for (int d = 0; d < 3; ++d) {
      const auto full = static_cast<float>(of_material[run.material][d]);
      for (const std::int32_t row : run.node) {
        float* const to = diagonal.component(d) + row;
        for (std::int32_t n = 0; n < run.length; ++n) {
          const float share = full * stiffness.scale[run.first_voxel + n];
          to[n] += share;
          to[n + 1] += share;
        }
      }
    }
  }
  return diagonal;
}

}  // namespace fascicle
