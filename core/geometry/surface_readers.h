#ifndef FASCICLE_CORE_GEOMETRY_SURFACE_READERS_H_
#define FASCICLE_CORE_GEOMETRY_SURFACE_READERS_H_

#include <cstdint>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "core/base/types.h"

namespace fascicle {

// A surface as stored in its file, before node numbers are checked. Filled by the readers.
struct RawSurface {
  std::vector<Vec3> nodes;
  std::vector<std::vector<std::int64_t>> polygons;  // node indices from 0, three or more; anything else is malformed
  std::vector<std::string> notes;                   // what was read in spite of a flaw
};

// Each adds malformed input to `problems`; its result must then be discarded. Each throws Stopped after a stop request.
RawSurface ReadStl(std::string_view bytes, const std::stop_token& stop, Problems& problems);
RawSurface ReadObj(std::string_view bytes, const std::stop_token& stop, Problems& problems);
RawSurface ReadPly(std::string_view bytes, const std::stop_token& stop, Problems& problems);
RawSurface ReadVtp(std::string_view bytes, const std::stop_token& stop, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_SURFACE_READERS_H_
