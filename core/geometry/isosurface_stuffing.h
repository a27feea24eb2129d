#ifndef FASCICLE_CORE_GEOMETRY_ISOSURFACE_STUFFING_H_
#define FASCICLE_CORE_GEOMETRY_ISOSURFACE_STUFFING_H_

#include "core/base/parallel.h"
#include "core/geometry/octree_lattice.h"
#include "core/geometry/triangle_tree.h"

namespace fascicle {

// The part of a lattice inside a surface. Nodes near the surface move onto it; tetrahedra that it still intersects are
// cut. Every dihedral angle is between 10.7 and 164.8 degrees, whatever the surface [Labelle and Shewchuk 2007, theorem
// 1]. Boundary nodes lie on the surface. The same bits for any number of threads. Observes the team's stop requests.
TetMesh StuffLattice(const Lattice& lattice, const TriangleTree& tree, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_ISOSURFACE_STUFFING_H_
