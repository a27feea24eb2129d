#ifndef FASCICLE_CLIENT_IMPORT_TETRAHEDRA_H_
#define FASCICLE_CLIENT_IMPORT_TETRAHEDRA_H_

#include <array>
#include <cstdint>
#include <vector>

#include "client/import/model.h"
#include "core/geometry/solid_cells.h"

namespace fascicle::client {

// The tetrahedra of all parts that have a material, in the order of the parts and of their elements.
struct Tetrahedra {
  std::vector<Tetrahedron> corners;                  // node indices
  std::vector<std::array<std::int32_t, 6>> middles;  // of tet10, in the order of kTetEdges; -1 for others
  std::vector<std::int32_t> part;                    // index of the part
  std::vector<std::int32_t> element;                 // index in the part
  // Whether every six tetrahedra stand for a hexahedron, which is kept.
  bool of_hexahedra = false;

  // The tetrahedra of an element of a scene: every `step`-th one begins an element.
  std::size_t step() const { return of_hexahedra ? 6 : 1; }
};

// The nodes of the hexahedron of tetrahedron t.
Hexahedron HexahedronOf(const Mesh& mesh, const Tetrahedra& all, std::size_t t);

// Hexahedra, wedges and pyramids are split as in core/geometry/solid_cells.h.
Tetrahedra MakeTetrahedra(const Mesh& mesh, bool of_hexahedra);

// The shape of elements that are not tetrahedra.
SolidShape SolidShapeOf(Shape shape);

// The triangles of a facet, split in the same way.
std::vector<Triangle> TrianglesOf(const Facet& facet);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_TETRAHEDRA_H_
