#ifndef FASCICLE_CORE_GEOMETRY_MESH_CHECKS_H_
#define FASCICLE_CORE_GEOMETRY_MESH_CHECKS_H_

#include <stop_token>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle {

// Measures of a mesh.
struct MeshReport {
  double volume = 0;                   // [m^3]
  Vec3 lowest = Vec3::Zero();          // corner of the bounding box [m]
  Vec3 highest = Vec3::Zero();         // corner of the bounding box [m]
  int components = 0;                  // face-connected parts
  double smallest_dihedral_angle = 0;  // [rad]
};

// Checks a mesh in metres and reports: no tetrahedra, indices out of range, non-finite coordinates, inverted,
// degenerate (smallest height under 1e-6 of the longest edge) and duplicate tetrahedra, faces shared by more than two
// tetrahedra, nodes without a tetrahedron, folded hexahedra, curved edges that are not edges of the mesh or that fold a
// tetrahedron, coincident nodes (closer than 1e-10 of the diagonal; nodes at least 2e-9 apart are distinct), more than
// one component, and sizes that no muscle has (over 10 m or under 0.1 mm; the message names the likely unit). Adds one
// line for each kind of problem, with the count and the first examples, counted from 0. Paths are left empty. When an
// index is out of range, only the bounding box is measured. O(n log n) time and O(n) memory for any mesh. Throws
// Stopped after a stop request.
MeshReport CheckMesh(const TetMesh& mesh, Problems& problems, const std::stop_token& stop = {});

// The same for a mesh of shapes.h, whose nodes and tetrahedra fit together by construction: only what its measures may
// make wrong. Several times faster.
void CheckMadeMesh(const TetMesh& mesh, Problems& problems, const std::stop_token& stop = {});

// Reorients all tetrahedra if every one has a negative volume (a file with the other convention); a mixture is left for
// CheckMesh to report. Returns whether it did so.
bool OrientConsistently(TetMesh& mesh);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_MESH_CHECKS_H_
