#include "core/scene/contact.h"

#include <map>
#include <utility>

namespace fascicle {

std::vector<TouchingPair> PairsOf(const std::vector<Contact>& contacts, std::size_t bodies) {
  std::map<std::pair<std::size_t, std::size_t>, TouchingPair> pairs;
  for (const Contact& contact : contacts) {
    std::vector<bool> may_touch(bodies, contact.bodies.empty());
    for (const std::int32_t body : contact.bodies) may_touch[static_cast<std::size_t>(body)] = true;
    for (std::size_t a = 0; a < bodies; ++a) {
      for (std::size_t b = a + 1; b < bodies; ++b) {
        if (may_touch[a] && may_touch[b]) pairs[{a, b}] = {a, b, contact.friction, contact.lasting};
      }
    }
  }
  std::vector<TouchingPair> all;
  for (const auto& [numbers, pair] : pairs) all.push_back(pair);
  return all;
}

}  // namespace fascicle
