#ifndef FASCICLE_CORE_BASE_FRAME_DIGEST_H_
#define FASCICLE_CORE_BASE_FRAME_DIGEST_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/digest.h"

namespace fascicle {

// The numbers of a frame as little-endian bytes, for the simulation's arrays and for clients' messages alike. Both have
// the same digest.
struct FrameBytes {
  using Bytes = std::span<const std::byte>;
  struct Field {
    std::string_view name;
    Bytes values;           // doubles
    Bytes all_values = {};  // doubles
  };
  struct Body {
    Bytes positions;  // 3 doubles per node
    std::vector<Field> fields;
    Bytes higher_order_positions = {};  // 3 doubles per node
  };
  struct Line {
    Bytes points;  // 3 doubles per point
    Bytes values;  // doubles
  };

  std::int64_t index = 0;
  double time = 0;  // [s]
  std::int64_t step = 0;
  std::vector<Body> bodies;
  Bytes series;  // doubles
  Bytes poses;   // 7 doubles per pose
  std::vector<Line> lines;
};

// SHA-256 over index, time, step, bodies (positions, fields with their names) and series, in this order, then over
// poses, lines and the values at higher-order nodes, each if there are any. Frames without them therefore have the same
// digest as before they existed. Every array is preceded by its number of items, so that different frames never have
// the same bytes.
Digest DigestOf(const FrameBytes& frame);

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_FRAME_DIGEST_H_
