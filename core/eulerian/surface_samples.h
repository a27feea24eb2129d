#ifndef FASCICLE_CORE_EULERIAN_SURFACE_SAMPLES_H_
#define FASCICLE_CORE_EULERIAN_SURFACE_SAMPLES_H_

#include <vector>

#include "core/geometry/triangle_mesh.h"

namespace fascicle {

// A point of a surface that stands for a part of the area around it.
struct SurfaceSample {
  std::int32_t triangle;
  Vec3 weights;  // barycentric, of the triangle's nodes
  double part;   // of the triangle's area
};

// Samples of a surface that are at most about `spacing` apart [unit of the surface]: the centroids of the parts of each
// triangle, at most 64 x 64.
std::vector<SurfaceSample> SamplesOf(const TriangleMesh& surface, double spacing);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_SURFACE_SAMPLES_H_
