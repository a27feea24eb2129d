#ifndef FASCICLE_CORE_TET_CHUNK_ORDER_H_
#define FASCICLE_CORE_TET_CHUNK_ORDER_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/types.h"

namespace fascicle {

// Divides elements into compact chunks of nearly equal size, within kChunkElements and kChunkNodes, by recursive
// coordinate bisection [Berger & Bokhari 1987, A partitioning strategy for nonuniform problems on multiprocessors, IEEE
// Trans. Comput. C-36], so that few nodes belong to several chunks. Within a chunk, each lane of the blocks processes a
// compact part of its own. Elements that share nodes are then in different blocks, and a sum at a node does not wait
// for the addition just before it.
//   elements     the elements to divide; reordered by chunk and block
//   middles      centroids of all elements [m]
//   count_nodes  number of distinct nodes of some elements
// Returns the end of each chunk in `elements`, ascending.
std::vector<std::size_t> CutIntoChunks(std::span<std::int32_t> elements, std::span<const Vec3> middles,
                                       const std::function<std::size_t(std::span<const std::int32_t>)>& count_nodes);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_CHUNK_ORDER_H_
