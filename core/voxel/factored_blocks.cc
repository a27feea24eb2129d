#include "core/voxel/factored_blocks.h"

namespace fascicle {
namespace {

// Added to the diagonal (relative), for zero-energy motions.
constexpr double kRegularization = 1e-9;

}  // namespace

BlockMatrix AssembleLevel(const LevelStiffness& K, const VoxelField<float>& shift) {
  const VoxelMesh& mesh = K.mesh();
  std::vector<std::array<std::int32_t, 8>> nodes_of(mesh.voxels());
  ForVoxels(mesh, [&](std::int32_t voxel, const GridIndex&, const std::array<std::int32_t, 8>& nodes) {
    nodes_of[voxel] = nodes;
  });
  BlockMatrix matrix;
  matrix.pattern = PatternOfElements(mesh.nodes(), nodes_of.size(), [&](std::size_t v) { return nodes_of[v]; });
  matrix.values.assign(matrix.pattern.blocks(), Mat3::Zero());
  for (const VoxelRun& run : mesh.runs()) {
    ForVoxelsOfRun(run, [&](std::int32_t voxel, const GridIndex&, const std::array<std::int32_t, 8>& nodes) {
      const BrickMatrix of_voxel = K.MatrixOf(voxel, run.material);
      for (int a = 0; a < 8; ++a) {
        for (int b = 0; b < 8; ++b) {
          matrix.values[matrix.pattern.PlaceOf(nodes[a], nodes[b])] += of_voxel.block<3, 3>(3 * a, 3 * b);
        }
      }
    });
  }
  for (std::int32_t n = 0; n < mesh.nodes() && shift.size() > 0; ++n) {
    matrix.values[matrix.pattern.PlaceOf(n, n)].diagonal() += shift.At(n);
  }
  return matrix;
}

bool FactoredBlocks::Factor(const BlockPattern& pattern, const BlockValues& values) {
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
          entries.push_back(!diagonal ? value : value == 0 ? 1 : (1 + kRegularization) * value);
        }
      }
    }
  }
  side_.resize(3 * pattern.rows());
  return solver_.Analyze(static_cast<std::int32_t>(side_.size()), rows, columns) && solver_.Factor(entries).ok;
}

}  // namespace fascicle
