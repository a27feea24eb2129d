#ifndef FASCICLE_SERVER_TRANSLATE_FIBRE_ENDS_H_
#define FASCICLE_SERVER_TRANSLATE_FIBRE_ENDS_H_

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/base/problems.h"
#include "server/translate/regions.h"

namespace fascicle::server {

// The nodes that fibres run between.
struct FibreEnds {
  std::span<const std::int32_t> origin, insertion;
};

// The two regions that `wire` (HarmonicFibres or FittedSolid at `path`) names; nothing where one is unknown or empty,
// or where both are the same. The ends point into `regions`.
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
