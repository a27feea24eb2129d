#ifndef FASCICLE_SERVER_TRANSLATE_FIBRE_ENDS_H_
#define FASCICLE_SERVER_TRANSLATE_FIBRE_ENDS_H_

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/base/problems.h"
#include "server/translate/regions.h"

namespace fascicle::server {

// The nodes at both ends of the fibres.
struct FibreEnds {
  std::span<const std::int32_t> origin, insertion;
};

// The two regions given by `wire` (HarmonicFibres or FittedSolid at `path`); nothing if one is unknown or empty, or if
// both are the same. The ends refer to `regions`.
template <class Wire>
std::optional<FibreEnds> FindFibreEnds(const Wire& wire, const std::string& path, const NamedRegions& regions,
                                       Problems& problems) {
  const auto origin = regions.names.Find(wire.origin(), JoinPath(path, "origin"), problems);
  const auto insertion = regions.names.Find(wire.insertion(), JoinPath(path, "insertion"), problems);
  if (!origin || !insertion) return std::nullopt;
  if (*origin == *insertion) {
    problems.Add(JoinPath(path, "insertion"), "is the region of the origin, too", "give two different regions");
    return std::nullopt;
  }
  const auto& from = regions.regions[*origin].nodes;
  const auto& to = regions.regions[*insertion].nodes;
  // Empty regions have been reported.
  if (from.empty() || to.empty()) return std::nullopt;
  return FibreEnds{from, to};
}

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_FIBRE_ENDS_H_
