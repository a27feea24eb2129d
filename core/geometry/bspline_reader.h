#ifndef FASCICLE_CORE_GEOMETRY_BSPLINE_READER_H_
#define FASCICLE_CORE_GEOMETRY_BSPLINE_READER_H_

#include <optional>
#include <string_view>

#include "core/base/problems.h"
#include "core/geometry/bspline_solid.h"

namespace fascicle {

// Reads a solid from a text of words and numbers separated by white space; `#` starts a comment:
//
//   bspline_solid
//   degrees 3 3 3
//   controls 4 4 6
//   knots w 0 0 0 0 0.3 0.6 1 1 1 1     (u, v, w; at equal distances on [0, 1] when absent)
//   points
//   x y z                               (one for each control point, u running fastest)
//
// Coordinates stay in the file's unit. Malformed text adds to `problems` (with empty paths) and returns nothing. Never
// allocates more than the text could fill.
std::optional<BsplineSolid> ReadBsplineSolid(std::string_view text, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_BSPLINE_READER_H_
