#ifndef FASCICLE_CLIENT_IMPORT_TETRAHEDRA_H_
#define FASCICLE_CLIENT_IMPORT_TETRAHEDRA_H_

#include <array>
#include <cstdint>
#include <vector>

#include "client/import/model.h"

namespace fascicle::client {

// The tetrahedra of all parts that have a material, in the order of the parts and of their elements.
struct Tetrahedra {
  std::vector<Tetrahedron> corners;                  // node indices
  std::vector<std::array<std::int32_t, 6>> middles;  // of tet10, in the order of kTetEdges; -1 for others
  std::vector<std::int32_t> part;                    // index of the part
  std::vector<std::int32_t> element;                 // index in the part
};

// Hexahedra, wedges and pyramids are split from their node with the lowest index, and their sides along the diagonal
// from the side's node with the lowest index. So neighbours match, and boxes are split as in MakeBox [Dompierre et al.
// 1999].
Tetrahedra MakeTetrahedra(const Mesh& mesh);

// The triangles of a facet, split in the same way.
std::vector<Triangle> TrianglesOf(const Facet& facet);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_TETRAHEDRA_H_
