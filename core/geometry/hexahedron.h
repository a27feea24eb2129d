#ifndef FASCICLE_CORE_GEOMETRY_HEXAHEDRON_H_
#define FASCICLE_CORE_GEOMETRY_HEXAHEDRON_H_

#include <array>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/geometry/brick_mesh.h"
#include "core/geometry/tet_mesh.h"

// Hexahedra of eight nodes, trilinear in coordinates from 0 to 1 along each axis.
namespace fascicle {

// Whether node a is at the far end along axis d.
constexpr bool IsFarNode(int a, int d) {
  return d == 0 ? ((a ^ a >> 1) & 1) != 0 : d == 1 ? (a >> 1 & 1) != 0 : a >> 2 != 0;
}

// Node of a hexahedron for each corner of a Brick, and the other way round.
inline constexpr std::array<int, 8> kBrickOrder = {0, 1, 3, 2, 4, 5, 7, 6};

using HexahedronNodes = std::array<Vec3, 8>;

// The weight of node a at coordinates x.
double TrilinearWeight(int a, const Vec3& x);
// The value at coordinates x of values at the nodes, and its derivatives by the coordinates, one column each.
Vec3 TrilinearValue(const HexahedronNodes& values, const Vec3& x);
Mat3 TrilinearSlopes(const HexahedronNodes& values, const Vec3& x);
// The coordinates of node a.
Vec3 NodeCoordinates(int a);
// The coordinates of a point of space, by Newton's method; nothing if it does not converge, far away from the
// hexahedron or where it is folded.
std::optional<Vec3> CoordinatesIn(const HexahedronNodes& nodes, const Vec3& point);

// The integrals of the shape functions over a hexahedron [unit of the nodes, cubed].
std::array<double, 8> NodeVolumes(const HexahedronNodes& nodes);

// Positions of the nodes of a hexahedron of a mesh.
HexahedronNodes NodesOfHexahedron(const TetMesh& mesh, std::size_t hexahedron);

// The boundary of a mesh of hexahedra: sides that belong to one hexahedron only, each with the boundary triangles of
// its tetrahedra: two, or one of a triangular side, whose last node is given twice. Outward, in the order of the
// hexahedra.
struct HexahedralBoundary {
  struct Triangles {
    std::array<Triangle, 2> of_side = {};
    std::size_t count = 0;
    const Triangle* begin() const { return of_side.data(); }
    const Triangle* end() const { return of_side.data() + count; }
  };
  std::vector<Quad> quads;
  std::vector<Triangles> triangles;
};
// Throws Stopped after a stop request.
HexahedralBoundary BoundaryOfHexahedra(const TetMesh& mesh, const std::stop_token& stop = {});

// Sets the tetrahedra of a mesh of hexahedra (SplitSolid). Tags are left alone.
void SplitHexahedra(TetMesh& mesh);

// Reverses the orientation of a hexahedron, a wedge or a pyramid.
void TurnOver(Hexahedron& hexahedron);

// The tetrahedra of hexahedron h are first[h] to first[h + 1] - 1; the first hexahedra + 1 numbers.
std::vector<std::size_t> FirstTetrahedra(const TetMesh& mesh);
// The hexahedron of each tetrahedron.
std::vector<std::int32_t> HexahedraOfTetrahedra(const TetMesh& mesh);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_HEXAHEDRON_H_
