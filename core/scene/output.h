#ifndef FASCICLE_CORE_SCENE_OUTPUT_H_
#define FASCICLE_CORE_SCENE_OUTPUT_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/fields.h"
#include "core/scene/output_fields.h"

namespace fascicle {

// A place within an element of a body's shape.
struct ProbePlace {
  std::int32_t element = 0;  // tetrahedron, hexahedron, brick, or triangle of a surface
  // Tetrahedron: barycentric coordinates of corners 1 to 3. Hexahedron, brick: from 0 to 1 along each axis. Triangle:
  // barycentric coordinates of corners 1 and 2.
  Vec3 coordinates = Vec3::Zero();
};
template <>
inline constexpr auto kFieldNames<ProbePlace> = FieldNames("", "");

// A point whose displacement and fields are written as series.
struct Probe {
  std::string name;
  std::int32_t body = 0;
  std::int32_t node = 0;                            // the nearest of the body's nodes()
  std::optional<ProbePlace> inside = std::nullopt;  // where it is if not at the node
};
template <>
inline constexpr auto kFieldNames<Probe> = FieldNames("name", "body", "point", "point");

// The point and axis for the moment of a support.
struct SupportMoment {
  std::int32_t body = 0;
  std::int32_t region = 0;                   // of the body
  std::optional<Vec3> point = std::nullopt;  // fixed in space [m]; absent: the default point (support_moment.h)
  std::optional<Vec3> axis = std::nullopt;   // unit
};
template <>
inline constexpr auto kFieldNames<SupportMoment> = FieldNames("body", "region", "point", "axis");

// What is stored of a run.
struct Output {
  double frame_interval = 0;  // [s]
  std::vector<OutputField> fields;
  std::vector<Probe> probes;
  std::optional<double> settle_speed;  // [m/s]
  std::vector<SupportMoment> moments = {};
  std::optional<Vec3> line_of_action = std::nullopt;  // of muscles; unit
};
template <>
inline constexpr auto kFieldNames<Output> = FieldNames("frame_interval", "fields", "probes", "settle_speed", "moments",
                                                       "line_of_action");

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_OUTPUT_H_
