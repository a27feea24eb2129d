#ifndef FASCICLE_CORE_EULERIAN_SOLID_SHAPE_H_
#define FASCICLE_CORE_EULERIAN_SOLID_SHAPE_H_

#include <vector>

#include "core/base/parallel.h"
#include "core/base/problems.h"
#include "core/eulerian/grid.h"
#include "core/geometry/bounds.h"
#include "core/geometry/triangle_mesh.h"

namespace fascicle {

// A solid in material space: its surface and the signed distance phi0 from it, sampled on a grid. Const, thread-safe.
class SolidShape {
 public:
  // surface [m]: accepted by CheckSolidSurface. spacing: of the samples [m], about half a cell of the solid's grid.
  SolidShape(TriangleMesh surface, double spacing, ThreadTeam& team);

  const TriangleMesh& surface() const { return surface_; }
  double volume() const { return volume_; }  // [m^3]
  // A grid of the given spacing [m] over the solid and two cells around it.
  EulerianGrid MaterialGrid(double spacing) const;
  // phi0 [m]: negative inside; trilinear between samples, and at least the distance from the samples outside of them.
  double Distance(const Vec3& X) const;

 private:
  TriangleMesh surface_;
  Bounds bounds_;  // of the surface's nodes
  EulerianGrid samples_;
  std::vector<double> distance_;  // at the nodes of samples_
  double volume_ = 0;
};

// Whether a surface bounds a solid that a grid of the given spacing [m] can represent: closed, oriented outwards,
// without self-intersections, and at least four cells across. Adds problems with empty paths.
void CheckSolidSurface(const TriangleMesh& surface, double spacing, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_SOLID_SHAPE_H_
