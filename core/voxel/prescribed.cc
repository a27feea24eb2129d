#include "core/voxel/prescribed.h"

#include "core/base/check.h"

namespace fascicle {
namespace {

// Calls body(node, d, displacement) for every prescribed component.
template <class Body>
void ForPrescribed(const VoxelMesh& mesh, const std::vector<VoxelSupport>& supports, const Body& body) {
  for (const VoxelSupport& support : supports) {
    for (const GridIndex& at : support.nodes) {
      const std::int32_t node = mesh.NodeAt(at);
      FASCICLE_CHECK(node >= 0, "CheckVoxelProblem has checked the nodes of supports");
      for (int d = 0; d < 3; ++d) {
        if (support.components[d]) body(node, d, support.displacement[d]);
      }
    }
  }
}

}  // namespace

PrescribedComponents::PrescribedComponents(const VoxelMesh& mesh, const std::vector<VoxelSupport>& supports)
    : of_nodes_(mesh.nodes(), 0) {
  ForPrescribed(mesh, supports,
                [this](std::int32_t node, int d, double) { of_nodes_[node] |= static_cast<std::uint8_t>(1 << d); });
  for (int d = 0; d < 3; ++d) {
    for (std::int32_t n = 0; n < mesh.nodes(); ++n) {
      if (of_nodes_[n] >> d & 1) numbers_.push_back(d * VoxelField<double>::StrideOf(mesh.nodes()) + n);
    }
  }
}

VoxelField<double> DisplacementsOf(const VoxelMesh& mesh, const std::vector<VoxelSupport>& supports) {
  VoxelField<double> u(mesh.nodes());
  ForPrescribed(mesh, supports, [&u](std::int32_t node, int d, double value) { u(node, d) = value; });
  return u;
}

}  // namespace fascicle
