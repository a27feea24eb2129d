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
};

// Hexahedra, wedges and pyramids are split as in core/geometry/solid_cells.h.
Tetrahedra MakeTetrahedra(const Mesh& mesh);

// The shape of elements that are not tetrahedra.
SolidShape SolidShapeOf(Shape shape);

// The triangles of a facet, split in the same way.
std::vector<Triangle> TrianglesOf(const Facet& facet);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_TETRAHEDRA_H_
