#ifndef FASCICLE_TESTS_BENCH_VOXEL_MATRIX_H_
#define FASCICLE_TESTS_BENCH_VOXEL_MATRIX_H_

#include <Eigen/SparseCore>
#include <vector>

#include "core/voxel/voxel_operator.h"

namespace fascicle::bench {

// The assembled K of a mesh of one material; unknown 3 n + d is component d of node n. In row order, Matrix is CSR.
template <class Matrix>
Matrix AssembleVoxels(const VoxelMesh& mesh, const VoxelMaterial& material) {
  const BrickMatrix K = BrickStiffness(mesh.spacing(), ModuliOf(material, Dilatation::kFull));
  Matrix matrix(3 * mesh.nodes(), 3 * mesh.nodes());
  // Column indices in each row of a node: of its 27 neighbours.
  matrix.reserve(Eigen::VectorXi::Constant(3 * mesh.nodes(), 81));
  ForVoxels(mesh, [&](std::int32_t, const GridIndex&, const std::array<std::int32_t, 8>& nodes) {
    for (int a = 0; a < 24; ++a) {
      for (int b = 0; b < 24; ++b) matrix.coeffRef(3 * nodes[a / 3] + a % 3, 3 * nodes[b / 3] + b % 3) += K(a, b);
    }
  });
  matrix.makeCompressed();
  return matrix;
}

}  // namespace fascicle::bench

#endif  // FASCICLE_TESTS_BENCH_VOXEL_MATRIX_H_
