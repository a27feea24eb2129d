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
  // Width of the lattice at the surface, about the length of the mesh's edges there; or, when 0, about how many
  // tetrahedra the mesh is to have.
  double size = 0;
  std::int64_t tetrahedra = 50000;
  // By how much edges may grow for each length of distance from the surface; 0: all are equally long.
  double grading = 0.5;
  // Holes up to this far across are filled; negative: up to a tenth of the surface's diagonal.
  double largest_hole = -1;
};

// What came out, in the surface's unit; angles [rad].
struct MeshingReport {
  SurfaceReport surface;
  double size = 0;
  AngleFigures angles;
  double volume = 0;
  double surface_volume = 0;  // enclosed by the repaired surface; what lies inside twice counts twice
  double lost_volume = 0;     // of parts that the lattice is too coarse to connect, left out
  // The largest distance of the mesh's outer nodes and triangle centroids from the surface, and of the surface's nodes
  // from the mesh.
  double surface_distance = 0;
  Vec3 furthest = Vec3::Zero();  // where that is

  double VolumeError() const { return volume / surface_volume - 1; }
};

struct MeshingResult {
  TetMesh mesh;
  MeshingReport report;
};

// Called now and then with the part that is done, from 0 to 1, and a word on what comes next.
using MeshingProgress = std::function<void(double, const char*)>;

// Fills a surface with tetrahedra: repairs it (surface_repair.h), stuffs it with a graded body-centred cubic lattice
// (octree_lattice.h, isosurface_stuffing.h), improves the angles and fits the volume (mesh_improvement.h). The surface
// is left repaired. A surface that cuts itself is meshed as what it winds round, and refused when that differs from the
// enclosed volume by more than 1 %; so are surfaces around several bodies. Nothing, with `problems`, when it is
// refused. The same bits for any number of threads.
std::optional<MeshingResult> Tetrahedralize(TriangleMesh& surface, const MeshingOptions& options, ThreadTeam& team,
                                            Problems& problems, const MeshingProgress& progress = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_TETRAHEDRALIZE_H_
