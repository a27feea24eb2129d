#ifndef FASCICLE_CORE_GEOMETRY_REGION_H_
#define FASCICLE_CORE_GEOMETRY_REGION_H_

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/geometry/brick_mesh.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle {

// The selectors of scene.proto, lengths in [m], directions of any non-zero length.
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
  std::vector<Triangle> triangles;  // of a tetrahedral surface: outward, all nodes in `nodes` (side, tag: the selected
                                    // ones)
  std::vector<std::int32_t> elements;    // ascending; tag: those with it; plane, box, sphere: whose centroid is inside;
                                         // side: whose centroid is no further than its depth from a face
  std::vector<Quad> quads;               // the same of a surface of bricks
  std::vector<Selector> selectors = {};  // what it was selected by; all hold
};

// Selects what a selector names; may be empty. Tag: the triangles with the tag, and if there are none the elements
// with it, and if there are none of these either the nodes with it and the surface between them; triangles inside of
// the body give nodes only. Elements are those with the tag in any case. Side: faces whose outward normal is
// within the angle. Round-off allowance of plane, box and sphere: 1e-9 of the mesh's diagonal; of the angle: 1e-9 rad.
// `surface` must be BoundaryTriangles(mesh).
Region SelectRegion(const TetMesh& mesh, const std::vector<Triangle>& surface, std::string name,
                    const Selector& selector);

// The same of bricks; the tag is their label. `surface` must be BoundaryQuads(mesh).
Region SelectRegion(const BrickMesh& mesh, const std::vector<Quad>& surface, std::string name,
                    const Selector& selector);

// Which points of space belong to a region of a surface: those within `slack` [m] of what each of its selectors names;
// of a side, those no further than its depth and the slack from the region's faces. Tags belong to elements, not to
// points: none. Const; may be asked from several threads at once.
class RegionPoints {
 public:
  // nodes: those that the region's triangles number.
  RegionPoints(const Region& region, const std::vector<Vec3>& nodes, double slack);
  bool Contain(const Vec3& x) const;

 private:
  struct Faces;
  std::vector<Selector> selectors_;
  double slack_;
  std::shared_ptr<const Faces> faces_;  // of a side
};

// What lies in both regions, under the name of the first.
Region Intersection(const Region& first, const Region& second);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_REGION_H_
