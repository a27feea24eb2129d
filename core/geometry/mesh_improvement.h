#ifndef FASCICLE_CORE_GEOMETRY_MESH_IMPROVEMENT_H_
#define FASCICLE_CORE_GEOMETRY_MESH_IMPROVEMENT_H_

#include <optional>

#include "core/base/parallel.h"
#include "core/geometry/triangle_tree.h"

namespace fascicle {

// Both functions observe the team's stop requests and then leave the mesh partly improved.

// Moves nodes to improve the worst dihedral angle around each: towards the mean of their neighbours, or to a better
// place found by local search [Freitag and Ollivier-Gooch 1997]. Boundary nodes move along the surface. The worst angle
// around a node never gets worse. The same bits for any number of threads.
void ImproveAngles(TetMesh& mesh, const TriangleTree& tree, int sweeps, ThreadTeam& team);

// Moves boundary nodes off the surface, so that flat triangles lie on both sides of it rather than below its convex
// parts. First each node moves until the mean distance of its triangles is zero; then all move by the same length until
// the total volume is `volume`, if given. Nodes stay where a move would reduce an angle that is under 15 degrees.
void FitSurface(TetMesh& mesh, const TriangleTree& tree, std::optional<double> volume, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_MESH_IMPROVEMENT_H_
