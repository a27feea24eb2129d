#include "core/tet/element_blocks.h"

namespace fascicle {

Sharing::Sharing(std::span<const std::int32_t> of_local, std::size_t places)
    : target(of_local.begin(), of_local.end()) {
  std::vector<std::int32_t> uses(places, 0);
  for (const std::int32_t place : of_local) {
    if (place != kNone) ++uses[place];
  }
  std::vector<std::int32_t> next(places);
  begin.push_back(0);
  for (std::size_t n = 0; n < places; ++n) {
    if (uses[n] == 1) continue;
    shared.push_back(static_cast<std::int32_t>(n));
    next[n] = begin.back();
    begin.push_back(begin.back() + uses[n]);
  }
  slots.resize(begin.back());
  std::int32_t slot = 0;
  for (std::int32_t& to : target) {
    if (to == kNone || uses[to] == 1) continue;
    slots[next[to]++] = slot;
    to = ~slot++;
  }
}

}  // namespace fascicle
