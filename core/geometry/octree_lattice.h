#ifndef FASCICLE_CORE_GEOMETRY_OCTREE_LATTICE_H_
#define FASCICLE_CORE_GEOMETRY_OCTREE_LATTICE_H_

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/parallel.h"
#include "core/geometry/triangle_tree.h"

namespace fascicle {

// Tetrahedra of a body-centred cubic lattice that cover the interior of a surface, coarser away from it [Labelle and
// Shewchuk 2007, 3.1]. The nodes are the corners and centres of an octree's leaves.
struct Lattice {
  Vec3 origin = Vec3::Zero();
  double half = 0;                                     // half the finest leaf's width
  std::vector<std::array<std::int32_t, 3>> positions;  // of nodes, as multiples of `half` from the origin
  std::vector<Tetrahedron> tetrahedra;

  Vec3 Position(std::size_t node) const {
    return origin + half * Vec3(positions[node][0], positions[node][1], positions[node][2]);
  }
};

// Leaves have the width `width` where the surface is nearer than that, and elsewhere at most `width` plus `grading`
// times the distance from the surface. Leaves that share an edge differ by a factor of at most two. Some tetrahedra lie
// outside of the surface. The same bits for any number of threads. Observes the team's stop requests.
Lattice MakeLattice(const TriangleMesh& surface, const TriangleTree& tree, double width, double grading,
                    ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_OCTREE_LATTICE_H_
