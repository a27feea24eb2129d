#ifndef FASCICLE_CORE_VOXEL_MODEL_H_
#define FASCICLE_CORE_VOXEL_MODEL_H_

#include <array>
#include <vector>

#include "core/geometry/voxel_mesh.h"
#include "core/voxel/voxel_operator.h"

namespace fascicle {

// Treatment of rotations.
enum class VoxelRotation {
  kSmall,  // linear elasticity, as in the paper: for small displacement gradients
  kLarge,  // corotated: linear in the frame of each brick, rotated by the rotation nearest to the deformation
           // gradient at its centre [Mueller & Gross 2004, Interactive virtual materials]
};

// The constant data of a body of voxels. Vectors (displacements, forces) refer to the axes of the grid, its
// `direction`. Thread-safe.
class VoxelModel {
 public:
  // Input must be checked (CheckVoxelProblem). The grid must outlive the model. Voxels of material m have materials[m -
  // 1].
  VoxelModel(const VoxelGrid& grid, std::vector<VoxelMaterial> materials, Dilatation dilatation,
             VoxelRotation rotation = VoxelRotation::kSmall)
      : grid_(&grid),
        rotation_(rotation),
        materials_(std::move(materials)),
        mesh_(grid),
        stiffness_(mesh_, materials_, dilatation, StiffnessOfVoxels(grid)),
        operator_(stiffness_) {}
  VoxelModel(const VoxelModel&) = delete;
  VoxelModel& operator=(const VoxelModel&) = delete;

  const VoxelGrid& grid() const { return *grid_; }
  VoxelRotation rotation() const { return rotation_; }
  const VoxelMesh& mesh() const { return mesh_; }
  const std::vector<VoxelMaterial>& materials() const { return materials_; }
  const VoxelStiffness& stiffness() const { return stiffness_; }
  // y = K x [N] for unrotated bricks.
  const VoxelOperator<double>& K() const { return operator_; }

 private:
  const VoxelGrid* grid_;
  VoxelRotation rotation_;
  std::vector<VoxelMaterial> materials_;
  VoxelMesh mesh_;
  VoxelStiffness stiffness_;
  VoxelOperator<double> operator_;
};

// Nodes with prescribed components, as indices in the lattice of corners.
struct VoxelSupport {
  std::vector<GridIndex> nodes;
  std::array<bool, 3> components = {true, true, true};
  Vec3 displacement = Vec3::Zero();  // of the prescribed components [m]
};

// A total force, divided equally among nodes.
struct VoxelNodalForce {
  std::vector<GridIndex> nodes;
  Vec3 total = Vec3::Zero();  // [N]
};

// A side of a voxel: 0 to 5 for -i, +i, -j, +j, -k, +k.
struct VoxelFace {
  GridIndex voxel;
  int side = 0;
};

struct VoxelTraction {
  std::vector<VoxelFace> faces;
  Vec3 traction = Vec3::Zero();  // [Pa]
};

struct VoxelLoads {
  std::vector<VoxelNodalForce> nodal_forces;
  std::vector<VoxelTraction> tractions;
  Vec3 body_force = Vec3::Zero();  // on all voxels [N/m^3]
};

// f += the nodal forces of the loads [N], consistent with the trilinear shape functions: area / 4 of a traction to each
// corner of a face, volume / 8 of the body force to each corner of a voxel.
void AddForces(const VoxelModel& model, const VoxelLoads& loads, VoxelField<double>& f);

// Nodes in the box low <= (i, j, k) <= high, in order.
std::vector<GridIndex> NodesInBox(const VoxelMesh& mesh, const GridIndex& low, const GridIndex& high);

// Outer faces: sides of solid voxels in the box low <= (i, j, k) <= high towards `side` without a solid neighbour, in
// order.
std::vector<VoxelFace> OuterFaces(const VoxelGrid& grid, int side, const GridIndex& low, const GridIndex& high);

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_MODEL_H_
