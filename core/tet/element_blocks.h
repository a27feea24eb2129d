#ifndef FASCICLE_CORE_TET_ELEMENT_BLOCKS_H_
#define FASCICLE_CORE_TET_ELEMENT_BLOCKS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// How the elements lie in memory for the loops over them: in chunks that fit the cache, each cut into blocks of
// kBlock elements whose numbers stand side by side, so that a vector instruction takes as many elements at once as it
// has lanes. A chunk's elements have one law. See README.md.
namespace fascicle {

// Elements of a block: a whole number of the widest vectors, of float too.
inline constexpr int kBlock = 16;
// A chunk ends before it has more. Its nodes' values then lie in the cache.
inline constexpr int kChunkElements = 4096;
inline constexpr int kChunkNodes = 1536;

// A point of the elements of a block at rest. The elements that the last block of a chunk lacks are those of the one
// before, without volume.
template <class S>
struct alignas(64) RestPoint {
  S Dm_inverse[9][kBlock];  // column by column [1/m]
  S volume[kBlock];         // [m^3]
};

// What the laws of the elements of a block are told of their fibres.
template <class S>
struct alignas(64) BlockFibres {
  S direction[3][kBlock];           // a0
  S activation_scale[kBlock];       // the part of the curve's value that an element makes its own
  std::int32_t activation[kBlock];  // curve
};

template <class S>
struct BlockArrays {
  std::vector<RestPoint<S>> points;    // of point q of block b: points[points of an element * b + q]
  std::vector<BlockFibres<S>> fibres;  // of each block
};

struct Chunk {
  std::int32_t group = 0, law = 0;
  std::size_t tet_begin = 0, tet_end = 0;
  std::size_t block_begin = 0, block_end = 0;
  std::size_t node_begin = 0, node_end = 0;  // in ElementChunks::nodes
};

// Where sums over chunks go that each chunk has for some of many places (nodes, patches): to the place itself where no
// other chunk has part in it, else to a slot of the chunk's own, and those are added up in the order of the chunks. So
// the sums are the same bits for any number of threads.
struct Sharing {
  static constexpr std::int32_t kNone = INT32_MAX;  // no place

  // of_local: the place of each sum, chunk by chunk, no place twice in a chunk; kNone for none.
  Sharing() = default;
  Sharing(std::span<const std::int32_t> of_local, std::size_t places);

  std::vector<std::int32_t> target;  // of each sum: its place, or ~slot, or kNone
  // Slots of place shared[i]: slots[begin[i] .. begin[i + 1]), ascending. Places without any sum are here too.
  std::vector<std::int32_t> shared, begin, slots;
};

struct ElementChunks {
  std::vector<Chunk> chunks;
  std::vector<std::int32_t> nodes;  // of each chunk, ascending
  // In its chunk's nodes: node a of lane k of block b is local[(nodes of an element * b + a) * kBlock + k].
  std::vector<std::uint16_t> local;
  std::vector<std::int32_t> slot;   // of each element: kBlock * block + lane
  std::vector<std::int32_t> patch;  // of each entry of `nodes`; Sharing::kNone without
  Sharing node_sums, patch_sums;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_ELEMENT_BLOCKS_H_
