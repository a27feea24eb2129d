#ifndef FASCICLE_CORE_GEOMETRY_SHAPES_H_
#define FASCICLE_CORE_GEOMETRY_SHAPES_H_

#include <array>

#include "core/geometry/tet_mesh.h"

namespace fascicle {

// The built-in shapes of scene.proto, with the same meaning. Lengths in [m]; arguments must have been checked.
// Hexahedra are split into six tetrahedra around the diagonal from local node 0 to 6 (Kuhn). With nodes 0-3 at the
// bottom, counter-clockwise, and 4-7 above them: (0,1,2,6)(0,2,3,6)(0,3,7,6)(0,7,4,6)(0,4,5,6)(0,5,1,6).
// Round shapes have an even number of divisions across. Each quarter (of the sphere: eighth) is the mirror image of the
// next, with local node 0 towards the middle. Squares are mapped to discs as in [Shirley and Chiu 1997, "A low
// distortion map between disk and square"]. Boundary nodes lie on the surface exactly, tetrahedra have similar volumes,
// and no dihedral angle is below 16 degrees at any resolution, provided that hexahedra are about as long as wide.

// Whether a mesh keeps the hexahedra beside the tetrahedra.
enum class Cells { kTetrahedra, kHexahedra };

// Node i + (nx+1) (j + (ny+1) k) is at (i, j, k): x varies fastest.
TetMesh MakeBox(const Vec3& origin, const Vec3& size, const std::array<int, 3>& divisions,
                Cells cells = Cells::kTetrahedra);

struct Fusiform {
  double length = 0;        // along z [m]
  double belly_radius = 0;  // [m]
  double end_radius = 0;    // [m]
  int divisions_across = 6;
  int divisions_along = 24;
};
TetMesh MakeFusiform(const Fusiform& shape, Cells cells = Cells::kTetrahedra);

struct Torus {
  double major_radius = 0;  // [m]
  double minor_radius = 0;  // [m]
  int divisions_around = 24;
  int divisions_across = 4;
};
TetMesh MakeTorus(const Torus& shape, Cells cells = Cells::kTetrahedra);

TetMesh MakeSphere(double radius, int divisions, Cells cells = Cells::kTetrahedra);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_SHAPES_H_
