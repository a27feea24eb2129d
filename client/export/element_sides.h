#ifndef FASCICLE_CLIENT_EXPORT_ELEMENT_SIDES_H_
#define FASCICLE_CLIENT_EXPORT_ELEMENT_SIDES_H_

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace fascicle::client {

// The sides of a brick, as corners in order around them, counter-clockwise seen from outside. Those of wedges and
// pyramids, bricks with repeated nodes, are triangles, too, or vanish.
inline std::vector<std::vector<std::uint32_t>> SidesOf(const std::array<std::uint32_t, 8>& b) {
  std::vector<std::vector<std::uint32_t>> sides = {{b[0], b[4], b[6], b[2]}, {b[1], b[3], b[7], b[5]},
                                                   {b[0], b[1], b[5], b[4]}, {b[2], b[6], b[7], b[3]},
                                                   {b[0], b[2], b[3], b[1]}, {b[4], b[5], b[7], b[6]}};
  for (std::vector<std::uint32_t>& side : sides) {
    side.erase(std::unique(side.begin(), side.end()), side.end());
    if (side.front() == side.back()) side.pop_back();
  }
  std::erase_if(sides, [](const auto& side) { return side.size() < 3; });
  return sides;
}

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_EXPORT_ELEMENT_SIDES_H_
