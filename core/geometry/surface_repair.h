#ifndef FASCICLE_CORE_GEOMETRY_SURFACE_REPAIR_H_
#define FASCICLE_CORE_GEOMETRY_SURFACE_REPAIR_H_

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/triangle_mesh.h"

namespace fascicle {

// A place on a surface where something is wrong, in the surface's unit.
struct SurfacePlace {
  Vec3 centre = Vec3::Zero();  // of the box around it
  double extent = 0;           // diagonal of that box
  double length = 0;           // of a hole's boundary
  std::int64_t count = 0;      // edges of a hole's boundary; pairs of triangles that cut each other
};

// "(1.2, 3.4, 5.6), 2.5 across".
std::string PlaceText(const SurfacePlace& place);

// What was done to a surface, and what is left to say about it.
struct SurfaceReport {
  std::int64_t removed_triangles = 0;  // without area, or the same as others
  std::int64_t turned_triangles = 0;   // against their neighbours, or inside out
  std::int64_t parts = 0;              // connected, after filling
  std::vector<SurfacePlace> holes;     // filled
  std::vector<SurfacePlace> cuts;      // where the surface cuts itself: left as they are
};

// Makes a surface closed and outward: joins nodes at the same place, removes triangles without area and duplicates,
// turns triangles round that look against their neighbours, fills holes no larger across than `largest_hole` with
// triangles of least area [Barequet and Sharir 1995], turns parts inside out that are not cavities of others, and looks
// for triangles that cut each other. A larger hole, edges of three or more triangles that do not close, and a one-sided
// surface are problems, each with its place.
SurfaceReport RepairSurface(TriangleMesh& surface, double largest_hole, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_SURFACE_REPAIR_H_
