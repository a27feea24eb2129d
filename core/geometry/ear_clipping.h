#ifndef FASCICLE_CORE_GEOMETRY_EAR_CLIPPING_H_
#define FASCICLE_CORE_GEOMETRY_EAR_CLIPPING_H_

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "core/geometry/tet_mesh.h"

namespace fascicle {

// The largest number of corners of a polygon that SplitPolygon takes; its time is about the square of this.
inline constexpr std::size_t kMostCorners = 20'000;

// Splits a polygon, given by nodes in order around it, into triangles with the same orientation whose corners are its
// own. Seen along its mean normal, the polygon may have any simple shape: corners that turn inwards, and corners on the
// straight line between their neighbours, which no triangle leaves out. A polygon that is a fan around its first corner
// is split into that fan, others by clipping ears [Meisters 1975]. A polygon that intersects itself is split somehow.
// Corners that repeat their predecessor are left out; fewer than three different ones give no triangle. Throws Stopped
// after a stop request.
std::vector<Triangle> SplitPolygon(const std::vector<Vec3>& nodes, std::span<const std::int64_t> polygon,
                                   const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_EAR_CLIPPING_H_
