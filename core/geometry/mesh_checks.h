#ifndef FASCICLE_CORE_GEOMETRY_MESH_CHECKS_H_
#define FASCICLE_CORE_GEOMETRY_MESH_CHECKS_H_

#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle {

// What is noteworthy about a mesh without being wrong.
struct MeshReport {
  double volume = 0;                   // [m^3]
  Vec3 lowest = Vec3::Zero();          // corner of the bounding box [m]
  Vec3 highest = Vec3::Zero();         // corner of the bounding box [m]
  int components = 0;                  // face-connected parts
  double smallest_dihedral_angle = 0;  // [rad]
};

// Checks a mesh in metres: no tetrahedra, indices out of range, non-finite coordinates, inverted, degenerate (smallest
// height under 1e-6 of the longest edge) and duplicate tetrahedra, faces of more than two tetrahedra, nodes of no
// tetrahedron, curved edges that the mesh does not have or that fold a tetrahedron, coincident nodes (closer than 1e-10
// of the diagonal; from 2e-9 on they are told apart), more than one component, a size that no muscle has (over 10 m or
// under 0.1 mm: names the likely unit). Adds every problem it finds, a line for each kind with count and first
// examples, counted from 0. Paths are left empty. When an index is out of range only the box of the report is measured.
// O(n log n) in time and O(n) in memory for any mesh.
MeshReport CheckMesh(const TetMesh& mesh, Problems& problems);

// Turns round tetrahedra with negative volume when all of them are (a file with the other convention); a mixture is
// left for CheckMesh to report. Returns whether it did.
bool OrientConsistently(TetMesh& mesh);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_MESH_CHECKS_H_
