#include "core/voxel/rigid_pieces.h"

namespace fascicle {
namespace {

// Added to the diagonal, for rotations that nothing resists.
constexpr double kRegularization = 1e-9;

// K + D in blocks, one for each pair of nodes that a voxel joins.
struct Assembled {
  Assembled(const LevelStiffness& K, const VoxelField<float>& shift) {
    const VoxelMesh& mesh = K.mesh();
    std::vector<std::array<std::int32_t, 8>> nodes_of(mesh.voxels());
    ForVoxels(mesh, [&](std::int32_t voxel, const GridIndex&, const std::array<std::int32_t, 8>& nodes) {
      nodes_of[voxel] = nodes;
    });
    pattern = PatternOfElements(mesh.nodes(), nodes_of.size(), [&](std::size_t v) { return nodes_of[v]; });
    values.assign(pattern.blocks(), Mat3::Zero());
    for (const VoxelRun& run : mesh.runs()) {
      ForVoxelsOfRun(run, [&](std::int32_t voxel, const GridIndex&, const std::array<std::int32_t, 8>& nodes) {
        const BrickMatrix of_voxel = K.MatrixOf(voxel, run.material);
        for (int a = 0; a < 8; ++a) {
          for (int b = 0; b < 8; ++b) {
            values[pattern.PlaceOf(nodes[a], nodes[b])] += of_voxel.block<3, 3>(3 * a, 3 * b);
          }
        }
      });
    }
    if (shift.size() == 0) return;
    for (std::int32_t n = 0; n < mesh.nodes(); ++n) values[pattern.PlaceOf(n, n)].diagonal() += shift.At(n);
  }
  BlockPattern pattern;
  BlockValues values;
};

}  // namespace

RigidPieces::RigidPieces(const LevelStiffness& K, const VoxelField<float>& shift,
                         const VoxelField<float>& inverse_diagonal, float largest_eigenvalue, ThreadTeam& team) {
  const VoxelMesh& mesh = K.mesh();
  const Assembled fine(K, shift);
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
  ok_ = Factor(galerkin.pattern(), coarse);
}

bool RigidPieces::Factor(const BlockPattern& pattern, BlockValues& values) {
  std::vector<std::int32_t> rows, columns;
  std::vector<double> entries;
  for (std::size_t i = 0; i < pattern.rows(); ++i) {
    for (std::int32_t k = pattern.begin[i]; k < pattern.begin[i + 1]; ++k) {
      const std::size_t j = pattern.column[k];
      if (j > i) continue;
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < (i == j ? a + 1 : 3); ++b) {
          const bool diagonal = i == j && a == b;
          const double value = values[k](a, b);
          rows.push_back(static_cast<std::int32_t>(3 * i + a));
          columns.push_back(static_cast<std::int32_t>(3 * j + b));
          // A motion that no free component follows stands by itself.
          entries.push_back(!diagonal ? value : value == 0 ? 1 : (1 + kRegularization) * value);
        }
      }
    }
  }
  side_.resize(3 * pattern.rows());
  return solver_.Analyze(static_cast<std::int32_t>(side_.size()), rows, columns) && solver_.Factor(entries).ok;
}

void RigidPieces::Correct(const VoxelField<float>& r, ThreadTeam& team, VoxelField<float>& x) {
  ForNodes(team, columns_.pattern.rows(), [&](std::size_t i) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (std::int32_t k = columns_.pattern.begin[i]; k < columns_.pattern.begin[i + 1]; ++k) {
      const std::int32_t n = columns_.pattern.column[k];
      sum += values_[columns_.source[k]].transpose() * Eigen::Vector3f(r(n, 0), r(n, 1), r(n, 2));
    }
    for (int c = 0; c < 3; ++c) side_[3 * i + c] = static_cast<double>(sum[c]);
  });
  solver_.Solve(side_);
  ForNodes(team, rows_.rows(), [&](std::size_t n) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (std::int32_t k = rows_.begin[n]; k < rows_.begin[n + 1]; ++k) {
      const double* const motion = side_.data() + 3 * static_cast<std::size_t>(rows_.column[k]);
      sum += values_[k] * Eigen::Vector3d(motion[0], motion[1], motion[2]).cast<float>();
    }
    for (int d = 0; d < 3; ++d) x(static_cast<std::int32_t>(n), d) = sum[d];
  });
}

std::size_t RigidPieces::bytes() const {
  return values_.size() * (sizeof(Eigen::Matrix3f) + 3 * sizeof(std::int32_t)) + side_.size() * sizeof(double);
}

}  // namespace fascicle
