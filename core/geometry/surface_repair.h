#ifndef FASCICLE_CORE_GEOMETRY_SURFACE_REPAIR_H_
#define FASCICLE_CORE_GEOMETRY_SURFACE_REPAIR_H_

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/triangle_mesh.h"

namespace fascicle {

// A place on a surface where something is wrong; lengths in the surface's unit.
struct SurfacePlace {
  Vec3 centre = Vec3::Zero();  // of the bounding box of the place
  double extent = 0;           // diagonal of that box
  double length = 0;           // of a hole's boundary
  std::int64_t count = 0;      // edges of a hole's boundary; pairs of intersecting triangles
};

// "(1.2, 3.4, 5.6), 2.5 across".
std::string PlaceText(const SurfacePlace& place);

// What was done to a surface, and the defects that remain.
struct SurfaceReport {
  std::int64_t removed_triangles = 0;  // without area, or duplicates
  std::int64_t welded_nodes = 0;       // joined with a node that is near but not at the same position
  double weld_distance = 0;            // up to which open edges' nodes are welded
  std::int64_t closed_slits = 0;       // holes without width
  std::int64_t turned_triangles = 0;   // reoriented
  std::int64_t parts = 0;              // connected parts after filling
  std::vector<SurfacePlace> holes;     // filled
  std::vector<SurfacePlace> cavities;  // parts inside of another part, whose inside is left empty
  std::vector<SurfacePlace> cuts;      // self-intersections; not repaired
};

// Makes a surface closed and outward. Joins nodes at the same position, and nodes of open edges that are nearer than
// 1e-6 of the diagonal; removes triangles without area and duplicates; orients neighbours consistently; closes slits
// (holes without width, where the edges on both sides are divided differently) of any length, and fills holes of at
// most `largest_hole` across with triangles of least area [Barequet and Sharir 1995]. Each part is then oriented
// outward, or inward if it lies inside an odd number of other parts: it is a cavity, whatever its orientation was.
// Reports self-intersections. A larger hole, edges of three or more triangles that do not bound a volume, and a
// one-sided surface are problems, each with its place. Throws Stopped after a stop request, and leaves the surface half
// repaired.
SurfaceReport RepairSurface(TriangleMesh& surface, double largest_hole, Problems& problems,
                            const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_SURFACE_REPAIR_H_
