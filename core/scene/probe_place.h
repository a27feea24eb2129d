#ifndef FASCICLE_CORE_SCENE_PROBE_PLACE_H_
#define FASCICLE_CORE_SCENE_PROBE_PLACE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/body.h"
#include "core/scene/output.h"

// Where probes are in their bodies. All functions are pure and thread-safe.
namespace fascicle {

// A probe at a point [m]; bodies have nodes and elements. At a node if it is within 1e-9 of the body's size; otherwise
// in the element that contains the point, or for a surface on the nearest triangle. Outside of all elements the nearest
// node is taken.
struct LocatedProbe {
  Probe probe;
  double outside = 0;  // distance of the point from the recorded place [m]
};
LocatedProbe LocateProbe(std::string name, std::int32_t body, const Shape& shape, const Vec3& point);

// The element in which the fields of a probe are evaluated: its own, or the first that has its node.
ProbePlace PlaceOf(const Probe& probe, const Shape& shape);

// The nodes of an element with their weights at a place, by linear shape functions: they add up to 1.
std::vector<std::pair<std::int32_t, double>> WeightsAt(const ProbePlace& place, const Shape& shape);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_PROBE_PLACE_H_
