#ifndef FASCICLE_CORE_GEOMETRY_MESH_QUALITY_H_
#define FASCICLE_CORE_GEOMETRY_MESH_QUALITY_H_

#include <stop_token>
#include <utility>
#include <vector>

#include "core/geometry/tet_mesh.h"

namespace fascicle {

// The smallest and the largest cosine of a tetrahedron's six dihedral angles. If it is flat or inverted, at least one
// is outside of [-1, 1].
struct Cosines {
  double lowest, highest;
};
Cosines DihedralCosines(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

// Dihedral angles of tetrahedra [rad].
struct AngleFigures {
  double smallest = 0;
  double largest = 0;
  double median = 0;  // of the smallest angle of each tetrahedron
};
// Throws Stopped after a stop request.
AngleFigures MeasureAngles(const TetMesh& mesh, const std::stop_token& stop = {});

// The face-connected part to which each tetrahedron belongs. Parts are counted from 0 in the order of their lowest
// tetrahedra. Throws Stopped after a stop request.
std::vector<std::int32_t> FaceConnectedParts(const TetMesh& mesh, const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_MESH_QUALITY_H_
