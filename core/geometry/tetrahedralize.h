#ifndef FASCICLE_CORE_GEOMETRY_TETRAHEDRALIZE_H_
#define FASCICLE_CORE_GEOMETRY_TETRAHEDRALIZE_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "core/base/parallel.h"
#include "core/base/problems.h"
#include "core/geometry/mesh_quality.h"
#include "core/geometry/surface_repair.h"
#include "core/geometry/tet_mesh.h"
#include "core/geometry/triangle_mesh.h"

namespace fascicle {

struct MeshingOptions {
  // Width of the lattice at the surface, about the edge length of the mesh there. If 0, it is chosen for the number of
  // tetrahedra below.
  double size = 0;
  std::int64_t tetrahedra = 50000;
  // Growth of the edge length per unit of distance from the surface; 0: uniform.
  double grading = 0.5;
  // Holes up to this far across are filled. Negative: a tenth of the surface's diagonal.
  double largest_hole = -1;
};

// Measures of the result, in the surface's unit; angles in [rad].
struct MeshingReport {
  SurfaceReport surface;
  double size = 0;
  AngleFigures angles;
  double volume = 0;
  double surface_volume = 0;  // enclosed by the repaired surface; regions enclosed twice count twice
  double lost_volume = 0;     // volume of parts that were left out because the lattice is too coarse to connect them
  // The largest distance from the mesh's boundary nodes and triangle centroids to the surface, and from the surface's
  // nodes to the mesh.
  double surface_distance = 0;
  Vec3 furthest = Vec3::Zero();  // where that distance occurs

  double VolumeError() const { return volume / surface_volume - 1; }
};

struct MeshingResult {
  TetMesh mesh;
  MeshingReport report;
};

// Called from time to time with the completed fraction, from 0 to 1, and a description of the next step.
using MeshingProgress = std::function<void(double, const char*)>;

// Fills a surface with tetrahedra: repairs it (surface_repair.h), stuffs it with a graded body-centred cubic lattice
// (octree_lattice.h, isosurface_stuffing.h), improves the angles and fits the volume (mesh_improvement.h). Leaves
// `surface` repaired. Of a surface that intersects itself, the region with a winding number above one half is meshed;
// the surface is refused when that volume differs from the enclosed volume by more than 1 %. Surfaces around several
// bodies are refused, too. Returns nothing and adds to `problems` when the surface is refused. The same bits for any
// number of threads. Observes the team's stop requests; `surface` is then half repaired.
std::optional<MeshingResult> Tetrahedralize(TriangleMesh& surface, const MeshingOptions& options, ThreadTeam& team,
                                            Problems& problems, const MeshingProgress& progress = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_TETRAHEDRALIZE_H_
