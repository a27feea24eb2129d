#ifndef FASCICLE_CORE_GEOMETRY_GMSH_TYPES_H_
#define FASCICLE_CORE_GEOMETRY_GMSH_TYPES_H_

#include <cstdint>

namespace fascicle::gmsh {

// Numbers of element types in .msh files, after the nodes of each. [Gmsh reference manual, "Node ordering"]
inline constexpr std::int64_t kTriangle3 = 2, kTetrahedron4 = 4, kHexahedron8 = 5, kTriangle6 = 9, kTetrahedron10 = 11,
                              kPoint = 15;

}  // namespace fascicle::gmsh

#endif  // FASCICLE_CORE_GEOMETRY_GMSH_TYPES_H_
