#ifndef FASCICLE_CORE_TET_ELEMENT_BLOCKS_H_
#define FASCICLE_CORE_TET_ELEMENT_BLOCKS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// Memory layout of the elements for the loops over them: chunks that fit the cache, each divided into blocks of kBlock
// elements whose values are adjacent, so that a vector instruction processes as many elements as it has lanes. All
// elements of a chunk have the same law. See README.md.
namespace fascicle {

// Elements per block: a multiple of the widest vector's lanes, for float, too.
inline constexpr int kBlock = 16;
// Most elements of a chunk; the values of its nodes then fit the cache.
inline constexpr int kChunkElements = 4096;
inline constexpr int kChunkNodes = 1536;

// Rest data of one quadrature point for the elements of a block. Unused lanes of a chunk's last block repeat the last
// element with zero volume.
template <class S>
struct alignas(64) RestPoint {
  S Dm_inverse[9][kBlock];  // column by column [1/m]
  S volume[kBlock];         // [m^3]
};

// Fibre arguments of the laws for the elements of a block.
template <class S>
struct alignas(64) BlockFibres {
  S direction[3][kBlock];           // a0 times the prestretch
  S activation_scale[kBlock];       // factor on the activation curve for each element
  std::int32_t activation[kBlock];  // index of the activation curve
};

// Numbers of a symmetric tensor at one point of a block's elements: component by component, xx, yy, zz, xy, yz, zx.
inline constexpr std::size_t kBranchTensor = 6 * kBlock;

template <class S>
struct BlockArrays {
  std::vector<RestPoint<S>> points;    // point q of block b is points[points of an element * b + q]
  std::vector<BlockFibres<S>> fibres;  // one for each block
};

struct Chunk {
  static constexpr std::size_t kElastic = SIZE_MAX;

  std::int32_t group = 0, law = 0;
  std::size_t tet_begin = 0, tet_end = 0;
  std::size_t block_begin = 0, block_end = 0;
  std::size_t node_begin = 0, node_end = 0;  // in ElementChunks::nodes
  // The first of its points among those of viscoelastic blocks, block by block; kElastic without Maxwell branches.
  std::size_t branch_point = kElastic;
};

// Target of sums over chunks at places (nodes, patches) that several chunks may share. If only one chunk contributes to
// a place, its sum goes there directly. Otherwise each chunk writes to a slot of its own, and the slots are added up in
// the order of the chunks. So sums have the same bits for any number of threads.
struct Sharing {
  static constexpr std::int32_t kNone = INT32_MAX;  // no place

  // of_local: the place of each sum, chunk by chunk, without duplicates within a chunk; kNone where there is none.
  Sharing() = default;
  Sharing(std::span<const std::int32_t> of_local, std::size_t places);

  std::vector<std::int32_t> target;  // for each sum: its place, or ~slot, or kNone
  // Place shared[i] has slots[begin[i] .. begin[i + 1]), ascending. Places without any sum are included.
  std::vector<std::int32_t> shared, begin, slots;
};

struct ElementChunks {
  std::vector<Chunk> chunks;
  std::vector<std::int32_t> nodes;  // nodes of each chunk, ascending
  // Index within the chunk's nodes: node a of lane k of block b is local[(nodes of an element * b + a) * kBlock + k].
  std::vector<std::uint16_t> local;
  std::vector<std::int32_t> slot;   // for each element: kBlock * block + lane
  std::vector<std::int32_t> patch;  // for each entry of `nodes`; Sharing::kNone without a patch
  Sharing node_sums, patch_sums;
  // The first patch of each hexahedron, by slot; Sharing::kNone without a patch. Its others follow. They receive sums
  // from no other element.
  std::vector<std::int32_t> element_patch;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_ELEMENT_BLOCKS_H_
