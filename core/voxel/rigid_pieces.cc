#include "core/voxel/rigid_pieces.h"

namespace fascicle {

RigidPieces::RigidPieces(const LevelStiffness& K, const VoxelField<float>& shift,
                         const VoxelField<float>& inverse_diagonal, float largest_eigenvalue, ThreadTeam& team) {
  const VoxelMesh& mesh = K.mesh();
  const BlockMatrix fine = AssembleLevel(K, shift);
  std::vector<RigidBlock> nodes, pieces;
  for (const GridIndex& at : mesh.NodePlaces()) {
    nodes.push_back({mesh.spacing().cwiseProduct(Vec3(at[0], at[1], at[2])), 0});
  }
  FreeComponents free(mesh.nodes());
  BlockValues inverse(mesh.nodes(), Mat3::Zero());
  for (std::int32_t n = 0; n < mesh.nodes(); ++n) {
    inverse[n].diagonal() = inverse_diagonal.At(n);
    for (int d = 0; d < 3; ++d) free[n][d] = inverse_diagonal(n, d) > 0;
  }
  const Prolongation P = SmoothedAggregation(fine.pattern, fine.values, free, nodes, inverse,
                                             static_cast<double>(largest_eigenvalue), pieces);
  GalerkinProduct galerkin(fine.pattern, P);
  BlockValues coarse;
  galerkin.Compute(fine.pattern, fine.values, P, team, coarse);
  rows_ = P.pattern;
  columns_ = galerkin.restriction();
  for (const Mat3& block : P.values) values_.push_back(block.cast<float>());
  ok_ = factors_.Factor(galerkin.pattern(), coarse);
}

void RigidPieces::Correct(const VoxelField<float>& r, ThreadTeam& team, VoxelField<float>& x) {
  const std::span<double> side = factors_.side();
  ForNodes(team, columns_.pattern.rows(), [&](std::size_t i) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (std::int32_t k = columns_.pattern.begin[i]; k < columns_.pattern.begin[i + 1]; ++k) {
      const std::int32_t n = columns_.pattern.column[k];
      sum += values_[columns_.source[k]].transpose() * Eigen::Vector3f(r(n, 0), r(n, 1), r(n, 2));
    }
    for (int c = 0; c < 3; ++c) side[3 * i + c] = static_cast<double>(sum[c]);
  });
  factors_.Solve();
  ForNodes(team, rows_.rows(), [&](std::size_t n) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (std::int32_t k = rows_.begin[n]; k < rows_.begin[n + 1]; ++k) {
      const double* const motion = side.data() + 3 * static_cast<std::size_t>(rows_.column[k]);
      sum += values_[k] * Eigen::Vector3d(motion[0], motion[1], motion[2]).cast<float>();
    }
    for (int d = 0; d < 3; ++d) x(static_cast<std::int32_t>(n), d) = sum[d];
  });
}

std::size_t RigidPieces::bytes() const {
  return values_.size() * (sizeof(Eigen::Matrix3f) + 3 * sizeof(std::int32_t)) + unknowns() * sizeof(double);
}

}  // namespace fascicle
