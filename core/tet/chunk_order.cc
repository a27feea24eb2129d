#include "core/tet/chunk_order.h"

#include <algorithm>

#include "core/tet/element_blocks.h"

namespace fascicle {
namespace {

// Small models use smaller chunks, down to kSmallChunk elements, so that there are at least kEnoughChunks for the
// threads.
constexpr std::size_t kSmallChunk = 1024;
constexpr std::size_t kEnoughChunks = 16;

// Partially sorts elements along the longest side of their bounding box so that the first `count` come before the rest.
void Bisect(std::span<std::int32_t> elements, std::span<const Vec3> middles, std::size_t count) {
  Vec3 low = middles[elements[0]], high = low;
  for (const std::int32_t e : elements) {
    low = low.cwiseMin(middles[e]);
    high = high.cwiseMax(middles[e]);
  }
  Eigen::Index axis;
  (high - low).maxCoeff(&axis);
  std::nth_element(
      elements.begin(), elements.begin() + static_cast<std::ptrdiff_t>(count), elements.end(),
      [&](std::int32_t a, std::int32_t b) { return std::pair(middles[a][axis], a) < std::pair(middles[b][axis], b); });
}

// Bisects recursively, down to the size of a block.
void SortByPlace(std::span<std::int32_t> elements, std::span<const Vec3> middles) {
  if (elements.size() <= kBlock) return;
  const std::size_t half = elements.size() / 2;
  Bisect(elements, middles, half);
  SortByPlace(elements.first(half), middles);
  SortByPlace(elements.subspan(half), middles);
}

// Distributes the elements of a chunk: lane k of the blocks processes the k-th part of them. If the last block is not
// full, its first lanes are used.
void DealToLanes(std::span<std::int32_t> elements) {
  const std::vector<std::int32_t> sorted(elements.begin(), elements.end());
  const std::size_t blocks = (sorted.size() + kBlock - 1) / kBlock;
  const std::size_t in_last = sorted.size() - kBlock * (blocks - 1);
  std::size_t next = 0;
  for (std::size_t lane = 0; lane < kBlock; ++lane) {
    for (std::size_t b = 0; b < (lane < in_last ? blocks : blocks - 1); ++b)
      elements[kBlock * b + lane] = sorted[next++];
  }
}

}  // namespace

std::vector<std::size_t> CutIntoChunks(std::span<std::int32_t> elements, std::span<const Vec3> middles,
                                       const std::function<std::size_t(std::span<const std::int32_t>)>& count_nodes) {
  const std::size_t most = std::clamp<std::size_t>(elements.size() / kEnoughChunks, kSmallChunk, kChunkElements);
  std::vector<std::size_t> ends;
  const std::function<void(std::size_t, std::size_t)> cut = [&](std::size_t begin, std::size_t end) {
    const std::span<std::int32_t> part = elements.subspan(begin, end - begin);
    if (part.size() <= most && count_nodes(part) <= kChunkNodes) {
      SortByPlace(part, middles);
      DealToLanes(part);
      ends.push_back(end);
      return;
    }
    const std::size_t pieces = std::max<std::size_t>(2, (part.size() + most - 1) / most);
    const std::size_t first = part.size() * (pieces / 2) / pieces;
    Bisect(part, middles, first);
    cut(begin, begin + first);
    cut(begin + first, end);
  };
  if (!elements.empty()) cut(0, elements.size());
  return ends;
}

}  // namespace fascicle
