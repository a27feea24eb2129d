#ifndef FASCICLE_CORE_SCENE_NODAL_FORCES_H_
#define FASCICLE_CORE_SCENE_NODAL_FORCES_H_

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "core/base/types.h"
#include "core/geometry/region.h"
#include "core/scene/body.h"

namespace fascicle {

// The region on which a load acts, for any element type.
struct LoadedRegion {
  // A face of the rest surface and its nodes, which share a force on it: consistently with the shape functions. Linear
  // triangles and rectangles, whose nodes are the corners, and quadratic triangles, whose nodes are the mid-edge nodes,
  // have equal shares. Triquadratic hexahedra have nine nodes on a side.
  struct Face {
    static constexpr std::size_t kMostNodes = 9;
    Face() = default;
    Face(const Vec3& a, int n, const std::array<std::int32_t, 4>& of);  // equal shares
    Vec3 area = Vec3::Zero();                                           // outward normal times area [m^2]
    int count = 0;                                                      // number of nodes
    std::array<std::int32_t, kMostNodes> nodes = {};
    std::array<double, kMostNodes> share = {};  // of the area, for each node [m^2]
  };
  std::vector<std::int32_t> nodes;
  std::vector<Face> faces;
  // The part of the elements' rest volume that belongs to each node: the integral of its shape function [m^3]. May be
  // negative at the corners of quadratic elements.
  std::map<std::int32_t, double> volumes;
};

// A bilinear side of a hexahedron, flat or not: the integrals of its shape functions. Exact for parallelograms, else by
// 2 x 2 Gauss points.
LoadedRegion::Face LoadedSide(const Quad& side, const std::vector<Vec3>& X);

// The volumes of a region's hexahedra that belong to each of the mesh's nodes [m^3].
std::map<std::int32_t, double> VolumesOfHexahedra(const Region& region, const TetMesh& mesh);

// A region of a mesh that has corner nodes only, without volumes.
//   X  rest positions of the mesh's nodes [m]
LoadedRegion LoadedRegionOf(const Region& region, const std::vector<Vec3>& X);
// A region of a body's mesh, with volumes.
LoadedRegion LoadedRegionOf(const Region& region, const Body& body);

// What a load acts on, so that the region must have some.
enum class LoadedPart { kNodes, kFaces, kElements };
LoadedPart LoadedPartOf(const Load& load);

// Whether the force depends on the present positions. NodalForcesOf is then the value at rest of a pressure, and
// nothing for springs.
bool DependsOnPositions(const Load& load);

// The force of a load on each node at scale 1 [N]; ordered by node, so that sums are reproducible.
// To add a kind of load: a message in scene.proto, a struct in acting.h, its translation, and its two functions in
// nodal_forces.cc.
std::map<std::int32_t, Vec3> NodalForcesOf(const Load& load, const LoadedRegion& region);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_NODAL_FORCES_H_
