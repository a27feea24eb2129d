#ifndef FASCICLE_CORE_SIM_FRAME_H_
#define FASCICLE_CORE_SIM_FRAME_H_

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/digest.h"
#include "core/base/types.h"
#include "core/scene/output_fields.h"

namespace fascicle {

struct FieldValues {
  std::string name;  // `velocity`, `cauchy_stress`, ... as in scene.proto
  FieldLocation location = FieldLocation::kNode;
  int components = 1;
  std::string unit;
  std::vector<double> values;  // component fastest
};

// A field in the frames of a method, with its values.
FieldValues FieldOf(OutputField field, Method method, std::vector<double> values);

struct BodyFrame {
  std::vector<Vec3> positions;  // [m]
  std::vector<FieldValues> fields;
};

// The state of all bodies at one time, as plain arrays.
struct Frame {
  std::int64_t index = 0;
  double time = 0;  // [s]
  std::int64_t step = 0;
  std::vector<BodyFrame> bodies;
  std::vector<double> series;  // one value for each SeriesInfo of the simulation
  Digest digest = {};
};

// Meaning of one value of Frame::series.
struct SeriesInfo {
  std::string name;  // `energy/elastic`, `muscle/volume_ratio`, `muscle/reaction/origin/z`, `probe/belly/x`
  std::string unit;
  std::string description;
};

// SHA-256 over index, time, step, positions, fields (names too) and series as little-endian bytes, in this order.
Digest DigestOf(const Frame& frame);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_FRAME_H_
