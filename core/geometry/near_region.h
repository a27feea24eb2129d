#ifndef FASCICLE_CORE_GEOMETRY_NEAR_REGION_H_
#define FASCICLE_CORE_GEOMETRY_NEAR_REGION_H_

#include <stop_token>
#include <string>
#include <vector>

#include "core/geometry/region.h"
#include "core/geometry/triangle_tree.h"

namespace fascicle {

// The boundary triangles of a mesh whose corners are all within `distance` of another surface, and their nodes.
// `surface` must be BoundaryTriangles(mesh); all lengths are in one unit. Throws Stopped after a stop request.
Region SelectNear(const TetMesh& mesh, const std::vector<Triangle>& surface, std::string name,
                  const TriangleTree& other, double distance, const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_NEAR_REGION_H_
