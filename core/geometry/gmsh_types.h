#ifndef FASCICLE_CORE_GEOMETRY_GMSH_TYPES_H_
#define FASCICLE_CORE_GEOMETRY_GMSH_TYPES_H_

#include <cstdint>

namespace fascicle::gmsh {

// Numbers of element types in .msh files, after the nodes of each. [Gmsh reference manual, "Node ordering"]
inline constexpr std::int64_t kTriangle3 = 2, kTetrahedron4 = 4, kHexahedron8 = 5, kTriangle6 = 9, kTetrahedron10 = 11,
                              kWedge6 = 6, kPyramid5 = 7, kHexahedron20 = 17, kPoint = 15;

// The corners of the edges of hexahedra of 20 and 27 nodes, in the order of their mid-edge nodes.
inline constexpr int kHexahedronEdges[12][2] = {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3},
                                                {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}};

}  // namespace fascicle::gmsh

#endif  // FASCICLE_CORE_GEOMETRY_GMSH_TYPES_H_
