#ifndef FASCICLE_CORE_GEOMETRY_MESH_IMPROVEMENT_H_
#define FASCICLE_CORE_GEOMETRY_MESH_IMPROVEMENT_H_

#include <optional>

#include "core/base/parallel.h"
#include "core/geometry/triangle_tree.h"

namespace fascicle {

// Moves nodes so that the worst angle around each gets better, those of the outside along the surface: towards the
// middle of their neighbours, or wherever a search around them finds it better [Freitag and Ollivier-Gooch 1997]. No
// angle that is the worst around its nodes gets worse. The same for any number of threads.
void ImproveAngles(TetMesh& mesh, const TriangleTree& tree, int sweeps, ThreadTeam& team);

// Moves outer nodes off the surface, so that flat triangles lie on both sides of it and not beneath its bulges: first
// each until the mean distance of its triangles is zero, then all by the same length until the whole volume is
// `volume`, if that is given. Nodes stay where an angle under 15 degrees would get smaller.
void FitSurface(TetMesh& mesh, const TriangleTree& tree, std::optional<double> volume, ThreadTeam& team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_MESH_IMPROVEMENT_H_
