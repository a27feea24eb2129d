#ifndef FASCICLE_CORE_GEOMETRY_VOXEL_MESH_H_
#define FASCICLE_CORE_GEOMETRY_VOXEL_MESH_H_

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/voxel_grid.h"

namespace fascicle {

// Consecutive solid voxels of one material along i. Their corners are four rows of consecutive nodes.
struct VoxelRun {
  std::int32_t i, j, k;      // of the first voxel
  std::int32_t length;       // voxels
  std::int32_t first_voxel;  // number of the first voxel
  std::int32_t material;     // of all of them, counted from 1
  std::int32_t node[4];      // first node of rows (j, k), (j + 1, k), (j, k + 1), (j + 1, k + 1)
};

// Consecutive nodes along i, numbered from `first`.
struct NodeRun {
  std::int32_t i, j, k;
  std::int32_t length;
  std::int32_t first;
};

// A range of voxel layers that one thread processes at a time. Neighbouring slabs share one plane of nodes, and slabs
// of even number share none with each other. So all even slabs and then all odd slabs may be summed up without locks,
// in an order that depends on the mesh only.
struct VoxelSlab {
  std::int32_t first_layer, end_layer;  // k
  std::int32_t first_run, end_run;
  std::int32_t first_node, end_node;    // all of its nodes
  std::int32_t first_inner, end_inner;  // nodes that no other slab has
};

// The solid voxels of a grid and their corners, numbered i fastest, then j, then k. Only data common to a run is
// stored, nothing per voxel or node: about a byte per voxel.
class VoxelMesh {
 public:
  VoxelMesh() = default;
  explicit VoxelMesh(const VoxelGrid& grid);

  // Joins 2x2x2 voxels of `fine` wherever at least one exists; material_of(place) >= 1 gives the material of each
  // result.
  template <class MaterialOf>
  static VoxelMesh Coarser(const VoxelMesh& fine, const MaterialOf& material_of);

  std::int32_t voxels() const { return voxels_; }
  std::int32_t nodes() const { return nodes_; }
  const GridIndex& size() const { return size_; }
  const Vec3& spacing() const { return spacing_; }  // [m]

  const std::vector<VoxelRun>& runs() const { return runs_; }
  const std::vector<NodeRun>& node_runs() const { return node_runs_; }
  const std::vector<VoxelSlab>& slabs() const { return slabs_; }
  // Node runs [begin, end) of plane k, 0 <= k <= size()[2].
  std::array<std::int32_t, 2> NodeRunsOfPlane(std::int32_t k) const;

  // The run at a place; null where there is none and outside of the grid. O(log(runs in a row)).
  const VoxelRun* RunAt(const GridIndex& at) const;
  // The voxel at a place; -1 where there is none and outside of the grid. O(log(runs in a row)).
  std::int32_t VoxelAt(const GridIndex& at) const;
  std::int32_t NodeAt(const GridIndex& at) const;
  // Grid index of each node; O(nodes) memory.
  std::vector<GridIndex> NodePlaces() const;

 private:
  struct Interval {
    std::int32_t first, end;
  };
  void AddRun(const GridIndex& first, std::int32_t length, std::int32_t material);
  // Call after all runs have been added, in order.
  void Finish();
  std::vector<Interval> VoxelIntervals(std::int32_t j, std::int32_t k) const;
  void NumberNodes();
  void CutSlabs();
  static std::vector<Interval> Union(std::vector<Interval> intervals);
  // Where row (j, k) of the coarser mesh has voxels.
  std::vector<Interval> CoarseIntervals(std::int32_t j, std::int32_t k) const;

  GridIndex size_ = {0, 0, 0};
  Vec3 spacing_ = Vec3::Ones();
  std::int32_t voxels_ = 0, nodes_ = 0;
  std::vector<VoxelRun> runs_;
  std::vector<std::int32_t> row_begin_;  // first run of each row j + size_j k, and the end
  std::vector<NodeRun> node_runs_;
  std::vector<std::int32_t> node_row_begin_;  // the same for node rows j + (size_j + 1) k
  std::vector<VoxelSlab> slabs_;
};

// Calls body(voxel, place, nodes): corner c = 0 to 7 is at the place plus (c & 1, c >> 1 & 1, c >> 2).
template <class Body>
void ForVoxelsOfRun(const VoxelRun& run, const Body& body) {
  for (std::int32_t n = 0; n < run.length; ++n) {
    std::array<std::int32_t, 8> nodes;
    for (int c = 0; c < 8; ++c) nodes[c] = run.node[c >> 1] + n + (c & 1);
    body(run.first_voxel + n, GridIndex{run.i + n, run.j, run.k}, nodes);
  }
}
template <class Body>
void ForVoxels(const VoxelMesh& mesh, const Body& body) {
  for (const VoxelRun& run : mesh.runs()) ForVoxelsOfRun(run, body);
}

template <class MaterialOf>
VoxelMesh VoxelMesh::Coarser(const VoxelMesh& fine, const MaterialOf& material_of) {
  VoxelMesh mesh;
  mesh.size_ = {(fine.size_[0] + 1) / 2, (fine.size_[1] + 1) / 2, (fine.size_[2] + 1) / 2};
  mesh.spacing_ = 2 * fine.spacing_;
  for (std::int32_t k = 0; k < mesh.size_[2]; ++k) {
    for (std::int32_t j = 0; j < mesh.size_[1]; ++j) {
      for (const Interval& interval : fine.CoarseIntervals(j, k)) {
        for (std::int32_t i = interval.first; i < interval.end; ++i)
          mesh.AddRun({i, j, k}, 1, material_of(GridIndex{i, j, k}));
      }
    }
  }
  mesh.Finish();
  return mesh;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_VOXEL_MESH_H_
