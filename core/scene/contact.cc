#include "core/scene/contact.h"

#include <algorithm>
#include <set>
#include <utility>

namespace fascicle {

bool Touches(const Contact& contact, std::size_t body) {
  return contact.bodies.empty() || std::find(contact.bodies.begin(), contact.bodies.end(),
                                             static_cast<std::int32_t>(body)) != contact.bodies.end();
}

std::vector<TouchingPair> PairsOf(const std::vector<Contact>& contacts, std::size_t bodies) {
  std::set<std::pair<std::size_t, std::size_t>> pairs;
  for (const Contact& contact : contacts) {
    for (std::size_t a = 0; a < bodies; ++a) {
      for (std::size_t b = a + 1; b < bodies; ++b) {
        if (Touches(contact, a) && Touches(contact, b)) pairs.insert({a, b});
      }
    }
  }
  std::vector<TouchingPair> all;
  for (const auto& [a, b] : pairs) all.push_back({a, b});
  return all;
}

}  // namespace fascicle
