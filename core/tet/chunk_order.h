#ifndef FASCICLE_CORE_TET_CHUNK_ORDER_H_
#define FASCICLE_CORE_TET_CHUNK_ORDER_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/types.h"

namespace fascicle {

// Cuts elements into compact chunks of nearly equal size, within kChunkElements and kChunkNodes, by recursive
// coordinate bisection [Berger & Bokhari 1987, A partitioning strategy for nonuniform problems on multiprocessors,
// IEEE Trans. Comput. C-36]: few nodes then lie in several chunks. Within a chunk every lane of its blocks goes through
// a compact part of its own: elements that share nodes come one block after another, so that a sum does not wait for
// the one just before it.
//   elements     what is to be cut; reordered, chunk by chunk and block by block
//   middles      of all elements [m]
//   count_nodes  how many nodes some elements have, each counted once
// Returns the end of each chunk in `elements`, ascending.
std::vector<std::size_t> CutIntoChunks(std::span<std::int32_t> elements, std::span<const Vec3> middles,
                                       const std::function<std::size_t(std::span<const std::int32_t>)>& count_nodes);

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_CHUNK_ORDER_H_
