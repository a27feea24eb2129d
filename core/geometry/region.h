#ifndef FASCICLE_CORE_GEOMETRY_REGION_H_
#define FASCICLE_CORE_GEOMETRY_REGION_H_

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/geometry/brick_mesh.h"
#include "core/geometry/hexahedron.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle {

// The selectors of scene.proto: lengths in [m], directions of any non-zero length.
struct TagSelector {
  std::int32_t tag = 0;
};
struct PlaneSelector {
  Vec3 point, normal;
};
struct BoxSelector {
  Vec3 min, max;
};
struct SphereSelector {
  Vec3 center;
  double radius = 0;
};
struct SideSelector {
  Vec3 direction;
  double max_angle = 0;  // [rad]
  double depth = 0;      // [m]
};
using Selector = std::variant<TagSelector, PlaneSelector, BoxSelector, SphereSelector, SideSelector>;

// A named part of a mesh.
struct Region {
  std::string name;
  std::vector<std::int32_t> nodes;  // ascending, no duplicates
  std::vector<Triangle> triangles;  // of a tetrahedral boundary: outward, all nodes in `nodes` (side, tag: the selected
                                    // ones)
  std::vector<std::int32_t> elements;    // ascending; tag: those with the tag; plane, box, sphere: centroid inside;
                                         // side: those with their centroid within the depth of a face
  std::vector<Quad> quads;               // the same for the boundary of bricks
  std::vector<Quad> sides = {};          // of hexahedra; `triangles` are those of these sides
  std::vector<Selector> selectors = {};  // the selectors that define it; all must hold
};

// Selects the nodes, boundary faces and elements that match a selector; all may be empty.
// Tag: the triangles with the tag; if there are none, the elements with it; if there are none of these either, the
// nodes with it and the boundary faces between them. Triangles inside of the body give nodes only. Elements are always
// those with the tag.
// Side: faces whose outward normal is within the angle of the direction.
// Tolerances: 1e-9 of the mesh's diagonal for plane, box and sphere; 1e-9 rad for the angle.
// `surface` must be BoundaryTriangles(mesh).
Region SelectRegion(const TetMesh& mesh, const std::vector<Triangle>& surface, std::string name,
                    const Selector& selector);

// The same for a mesh of hexahedra, whose region has sides and their triangles. `boundary` must be
// BoundaryOfHexahedra(mesh).
Region SelectRegion(const TetMesh& mesh, const HexahedralBoundary& boundary, std::string name,
                    const Selector& selector);

// The same for bricks; the tag is their label. `surface` must be BoundaryQuads(mesh).
Region SelectRegion(const BrickMesh& mesh, const std::vector<Quad>& surface, std::string name,
                    const Selector& selector);

// Decides which points of space belong to a region of a surface: those within `slack` [m] of every selector's set. For
// a side selector: those within its depth plus the slack of the region's faces. Tag selectors contain no points,
// because tags belong to elements. Const and thread-safe.
class RegionPoints {
 public:
  // nodes: positions of the nodes that the region's triangles refer to.
  RegionPoints(const Region& region, const std::vector<Vec3>& nodes, double slack);
  bool Contain(const Vec3& x) const;

 private:
  struct Faces;
  std::vector<Selector> selectors_;
  double slack_;
  std::shared_ptr<const Faces> faces_;  // for side selectors
};

// The intersection of two regions, with the name of the first.
Region Intersection(const Region& first, const Region& second);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_REGION_H_
