#include "core/voxel/galerkin.h"

#include <array>
#include <optional>

#include "core/base/check.h"

namespace fascicle {
namespace {

// One of the eight voxels that form a coarse one.
struct Child {
  std::int32_t voxel = -1;  // -1: none
  std::int32_t material = 0;
  std::array<std::int32_t, 8> nodes = {};
};
using Children = std::array<Child, 8>;

Children ChildrenOf(const VoxelMesh& fine, const GridIndex& coarse) {
  Children children;
  for (int c = 0; c < 8; ++c) {
    const GridIndex at = {2 * coarse[0] + (c & 1), 2 * coarse[1] + (c >> 1 & 1), 2 * coarse[2] + (c >> 2)};
    const VoxelRun* const run = fine.RunAt(at);
    if (run == nullptr) continue;
    const std::int32_t n = at[0] - run->i;
    children[c].voxel = run->first_voxel + n;
    children[c].material = run->material;
    for (int corner = 0; corner < 8; ++corner) children[c].nodes[corner] = run->node[corner >> 1] + n + (corner & 1);
  }
  return children;
}

// Whether the coarse voxel has the stiffness of a plain brick, like its eight children.
bool AreAlike(const Children& children, const std::vector<float>& scale, const FixedComponents& fixed) {
  for (const Child& child : children) {
    if (child.voxel < 0 || child.material != children[0].material) return false;
    if (scale[child.voxel] == 0 || scale[child.voxel] != scale[children[0].voxel]) return false;
    if (fixed.empty()) continue;
    for (const std::int32_t node : child.nodes) {
      if (fixed[node] != 0) return false;
    }
  }
  return true;
}

// Expresses the rows of a child's corners in those of the coarse voxel: P^T times rows, axis by axis. Along an axis,
// the lower child spans the coarse end and the midpoint, the upper one the midpoint and the other end.
void InterpolateRowsTransposed(int child, BrickMatrix& rows) {
  for (int axis = 0; axis < 3; ++axis) {
    const bool upper = (child >> axis & 1) != 0;
    for (int low = 0; low < 8; ++low) {
      if (low >> axis & 1) continue;
      const int high = low | 1 << axis;
      auto at_low = rows.middleRows<3>(3 * low);
      auto at_high = rows.middleRows<3>(3 * high);
      if (upper) {
        at_low *= 0.5;
        at_high += at_low;
      } else {
        at_high *= 0.5;
        at_low += at_high;
      }
    }
  }
}

// P^T K P.
BrickMatrix Coarsened(int child, BrickMatrix K) {
  InterpolateRowsTransposed(child, K);
  K.transposeInPlace();
  InterpolateRowsTransposed(child, K);
  return K;
}

// R K R^T.
void Turn(const Mat3& R, BrickMatrix& K) {
  for (int c = 0; c < 8; ++c) K.middleRows<3>(3 * c) = R * K.middleRows<3>(3 * c).eval();
  for (int c = 0; c < 8; ++c) K.middleCols<3>(3 * c) = K.middleCols<3>(3 * c).eval() * R.transpose();
}

bool IsolateFixed(const Child& child, const FixedComponents& fixed, BrickMatrix& K) {
  bool any = false;
  for (int c = 0; c < 8; ++c) {
    for (int d = 0; d < 3; ++d) {
      if ((fixed[child.nodes[c]] >> d & 1) == 0) continue;
      K.row(3 * c + d).setZero();
      K.col(3 * c + d).setZero();
      any = true;
    }
  }
  return any;
}

bool TouchesFixed(const Child& child, const FixedComponents& fixed) {
  if (fixed.empty()) return false;
  std::uint8_t any = 0;
  for (const std::int32_t node : child.nodes) any |= fixed[node];
  return any != 0;
}

}  // namespace

VoxelMesh LevelStiffness::CoarserMesh(const VoxelMesh& fine) {
  return VoxelMesh::Coarser(fine, [&fine](const GridIndex& at) {
    for (const Child& child : ChildrenOf(fine, at)) {
      if (child.voxel >= 0) return child.material;
    }
    FASCICLE_CHECK(false, "a coarse voxel has a child");
  });
}

LevelStiffness::LevelStiffness(const VoxelMesh& mesh, VoxelStiffness stiffness,
                               std::optional<BrickRotations<float>> rotations)
    : mesh_(&mesh),
      stiffness_(std::move(stiffness)),
      rotations_(std::move(rotations)),
      operator_(stiffness_),
      slab_begin_(mesh.slabs().size() + 1, 0) {
  for (const BrickModuli<double>& moduli : stiffness_.moduli) {
    of_material_.push_back(BrickStiffness(mesh.spacing(), moduli));
  }
}

LevelStiffness::LevelStiffness(const VoxelMesh& mesh, const LevelStiffness& fine, const FixedComponents& fixed,
                               ThreadTeam& team)
    : LevelStiffness(mesh, VoxelStiffness(mesh, fine.stiffness_.moduli)) {
  FindOwn(fine, fixed);
  FillOwn(fine, fixed, team);
}

void LevelStiffness::FindOwn(const LevelStiffness& fine, const FixedComponents& fixed) {
  own_.assign(mesh_->voxels(), -1);
  for (std::size_t s = 0; s < mesh_->slabs().size(); ++s) {
    const VoxelSlab& slab = mesh_->slabs()[s];
    slab_begin_[s] = static_cast<std::int32_t>(blocks_.size());
    int lane = kBrickBlock;  // a block belongs to one slab
    for (std::int32_t r = slab.first_run; r < slab.end_run; ++r) {
      ForVoxelsOfRun(mesh_->runs()[r],
                     [&](std::int32_t voxel, const GridIndex& at, const std::array<std::int32_t, 8>& nodes) {
                       const Children children = ChildrenOf(*fine.mesh_, at);
                       if (!fine.rotations_ && AreAlike(children, fine.stiffness_.scale, fixed)) {
                         stiffness_.scale[voxel] = fine.stiffness_.scale[children[0].voxel];
                         return;
                       }
                       stiffness_.scale[voxel] = 0;
                       if (lane == kBrickBlock) {
                         blocks_.emplace_back();
                         lane = 0;
                       }
                       PackedBricks& block = blocks_.back();
                       for (int k = lane; k < kBrickBlock; ++k) {
                         for (int row = 0; row < 4; ++row) block.node[row][k] = nodes[2 * row];
                       }
                       own_[voxel] = kBrickBlock * static_cast<std::int32_t>(blocks_.size() - 1) + lane++;
                       block.bricks = lane;
                       ++own_count_;
                     });
    }
  }
  slab_begin_.back() = static_cast<std::int32_t>(blocks_.size());
}

void LevelStiffness::FillOwn(const LevelStiffness& fine, const FixedComponents& fixed, ThreadTeam& team) {
  std::vector<std::array<BrickMatrix, 8>> coarsened(fine.of_material_.size());
  for (std::size_t m = 0; m < coarsened.size(); ++m) {
    for (int c = 0; c < 8; ++c) coarsened[m][c] = Coarsened(c, fine.of_material_[m]);
  }
  const auto matrix_of = [&](const GridIndex& at) {
    BrickMatrix K = BrickMatrix::Zero();
    const Children children = ChildrenOf(*fine.mesh_, at);
    for (int c = 0; c < 8; ++c) {
      const Child& child = children[c];
      if (child.voxel < 0) continue;
      const float scale = fine.stiffness_.scale[child.voxel];
      if (scale != 0 && !fine.rotations_ && !TouchesFixed(child, fixed)) {
        K += static_cast<double>(scale) * coarsened[child.material][c];
        continue;
      }
      BrickMatrix of_child = fine.MatrixOf(child.voxel, child.material);
      if (!fixed.empty()) IsolateFixed(child, fixed, of_child);
      K += Coarsened(c, of_child);
    }
    return K;
  };
  team.For(mesh_->runs().size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      ForVoxelsOfRun(mesh_->runs()[r],
                     [&](std::int32_t voxel, const GridIndex& at, const std::array<std::int32_t, 8>&) {
                       if (own_[voxel] < 0) return;
                       const BrickMatrix K = matrix_of(at);
                       PackedBricks& block = blocks_[own_[voxel] / kBrickBlock];
                       const int lane = own_[voxel] % kBrickBlock;
                       for (int row = 0, entry = 0; row < 24; ++row) {
                         for (int column = 0; column <= row; ++column, ++entry) {
                           block.entries[entry][lane] = static_cast<float>(K(row, column));
                         }
                       }
                     });
    }
  });
}

BrickMatrix LevelStiffness::MatrixOf(std::int32_t voxel, std::int32_t material) const {
  if (own_.empty() || own_[voxel] < 0) {
    BrickMatrix K = static_cast<double>(stiffness_.scale[voxel]) * of_material_[material];
    if (rotations_) Turn(rotations_->At(voxel), K);
    return K;
  }
  const PackedBricks& block = blocks_[own_[voxel] / kBrickBlock];
  const int lane = own_[voxel] % kBrickBlock;
  BrickMatrix K;
  for (int row = 0, entry = 0; row < 24; ++row) {
    for (int column = 0; column <= row; ++column, ++entry) {
      K(row, column) = K(column, row) = static_cast<double>(block.entries[entry][lane]);
    }
  }
  return K;
}

void LevelStiffness::Apply(const VoxelField<float>& x, ThreadTeam& team, VoxelField<float>& y) const {
  ForSlabs(*mesh_, team, [&](std::size_t s) {
    if (rotations_) {
      ClearSlab(*mesh_, s, y);
      RotatedTask<float> task = {};
      static_cast<ProductTask<float>&>(task) = operator_.TaskOf(s, x, y);
      for (int k = 0; k < 9; ++k) task.rotation[k] = rotations_->component(k);
      kernels_->rotated_product(task);
      return;
    }
    operator_.ApplySlab(s, x, y);
    PackedTask task;
    task.blocks = blocks_.data() + slab_begin_[s];
    task.block_count = slab_begin_[s + 1] - slab_begin_[s];
    for (int d = 0; d < 3; ++d) {
      task.x[d] = x.component(d);
      task.y[d] = y.component(d);
    }
    kernels_->packed(task);
  });
}

VoxelField<float> LevelStiffness::RotatedDiagonal() const {
  VoxelField<float> diagonal(mesh_->nodes());
  for (const VoxelRun& run : mesh_->runs()) {
    const BrickMatrix& K = of_material_[run.material];
    ForVoxelsOfRun(run, [&](std::int32_t voxel, const GridIndex&, const std::array<std::int32_t, 8>& nodes) {
      const Mat3 R = rotations_->At(voxel);
      for (int c = 0; c < 8; ++c) {
        const Mat3 block = R * K.block<3, 3>(3 * c, 3 * c) * R.transpose();
        diagonal.Add(nodes[c], static_cast<double>(stiffness_.scale[voxel]) * block.diagonal());
      }
    });
  }
  return diagonal;
}

VoxelField<float> LevelStiffness::Diagonal() const {
  if (rotations_) return RotatedDiagonal();
  VoxelField<float> diagonal = DiagonalOf(stiffness_);
  for (const PackedBricks& block : blocks_) {
    for (int k = 0; k < block.bricks; ++k) {
      for (int row = 0; row < 24; ++row) {
        const int corner = row / 3;
        diagonal(block.node[corner >> 1][k] + (corner & 1), row % 3) += block.entries[row * (row + 3) / 2][k];
      }
    }
  }
  return diagonal;
}

std::size_t LevelStiffness::bytes() const {
  return (rotations_ ? 9 * stiffness_.scale.size() * sizeof(float) : 0) + stiffness_.scale.size() * sizeof(float) +
         own_.size() * sizeof(std::int32_t) + blocks_.size() * sizeof(PackedBricks) +
         mesh_->runs().size() * sizeof(VoxelRun) + mesh_->node_runs().size() * (sizeof(NodeRun) + sizeof(TransferRun));
}

}  // namespace fascicle
