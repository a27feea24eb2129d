#ifndef FASCICLE_CORE_SKELETON_WRAP_SURFACE_H_
#define FASCICLE_CORE_SKELETON_WRAP_SURFACE_H_

#include <optional>
#include <string>

#include "core/base/pose.h"
#include "core/base/types.h"

namespace fascicle {

// A surface of a bone around which muscles pass.
struct WrapSurface {
  enum class Kind {
    kCylinder,   // about the z axis: radius, length
    kSphere,     // radius
    kEllipsoid,  // radii along the axes
  };

  std::string name;
  int bone = 0;  // -1: the ground
  Pose pose;     // of its frame, in the bone's frame
  Kind kind = Kind::kCylinder;
  double radius = 0;          // [m]
  double length = 0;          // of a cylinder [m]
  Vec3 radii = Vec3::Zero();  // of an ellipsoid [m]
  // The side on which muscles pass: the sign of this direction of the surface's frame. 0: the shorter way.
  int side_axis = 0;
  int side = 0;
};

// Where a taut line touches a surface.
struct Wrapping {
  Vec3 first, last;   // the ends of the part in contact [m]
  double length = 0;  // of that part [m]
};

// How the shortest line from a to b passes around a surface, all in the surface's frame [m]. Nothing if the straight
// line is shortest, or if a or b are inside. A straight line that passes on the wrong side of a surface with `side` is
// led around it. Cylinders and spheres: closed forms (helices and great circles). Ellipsoids: geodesics, integrated
// from a tangent point whose place is found by Newton's method [Scholz et al. 2015, A fast multi-obstacle muscle
// wrapping method using natural geodesic variations], to 1e-10 of the radii.
std::optional<Wrapping> Wrap(const WrapSurface& surface, const Vec3& a, const Vec3& b);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SKELETON_WRAP_SURFACE_H_
