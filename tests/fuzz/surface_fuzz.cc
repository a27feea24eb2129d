// Any bytes as a surface file; the first byte selects the format. What is read must pass through the repair.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/check.h"
#include "core/geometry/surface_repair.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::string_view kNames[] = {"s.stl", "s.obj", "s.ply", "s.vtp"};
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  fascicle::Problems problems;
  std::optional<fascicle::TriangleMesh> surface =
      fascicle::ReadSurface(kNames[data[0] % std::size(kNames)], bytes, problems);
  FASCICLE_CHECK(surface.has_value() == problems.empty(), "a surface or problems");
  if (surface) fascicle::RepairSurface(*surface, 1, problems);
  return 0;
}
