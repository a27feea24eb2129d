#ifndef FASCICLE_CORE_SCENE_OUTPUT_H_
#define FASCICLE_CORE_SCENE_OUTPUT_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/fields.h"
#include "core/scene/output_fields.h"

namespace fascicle {

// A node whose displacement is written as a series.
struct Probe {
  std::string name;
  std::int32_t body = 0;
  std::int32_t node = 0;  // of the body's nodes()
};
template <>
inline constexpr auto kFieldNames<Probe> = FieldNames("name", "body", "point");

// What is stored of a run.
struct Output {
  double frame_interval = 0;  // [s]
  std::vector<OutputField> fields;
  std::vector<Probe> probes;
  std::optional<double> settle_speed;  // [m/s]
};
template <>
inline constexpr auto kFieldNames<Output> = FieldNames("frame_interval", "fields", "probes", "settle_speed");

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_OUTPUT_H_
