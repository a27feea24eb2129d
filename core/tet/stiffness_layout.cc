#include "core/tet/stiffness_layout.h"

#include <algorithm>

#include "core/base/check.h"

namespace fascicle {

StiffnessLayout::StiffnessLayout(const TetModel& model, const BlockPattern& pattern, const std::stop_token& stop) {
  model.VisitElement([&]<class Element>(Element) { SetPlaces<Element>(model, pattern, stop); });
}

template <class Element>
void StiffnessLayout::SetPlaces(const TetModel& model, const BlockPattern& pattern, const std::stop_token& stop) {
  pairs_ = Element::kNodes * (Element::kNodes + 1) / 2;
  const ElementChunks& chunks = model.chunks();
  const std::size_t blocks = chunks.chunks.empty() ? 0 : chunks.chunks.back().block_end;
  places_.resize(pairs_ * kBlock * blocks);
  turned_.resize(pairs_ * blocks);
  std::vector<std::int32_t> local_of(pattern.blocks(), -1), all, of_chunk, of_pair;
  for (const Chunk& chunk : chunks.chunks) {
    ThrowIfStopped(stop);
    of_chunk.clear();
    of_pair.clear();
    for (std::size_t e = chunk.tet_begin; e < chunk.tet_end; ++e) {
      const auto nodes = model.NodesOf<Element>(e);
      for (int a = 0; a < Element::kNodes; ++a) {
        for (int b = 0; b <= a; ++b) {
          const auto [low, high] = std::minmax(nodes[a], nodes[b]);
          of_pair.push_back(pattern.PlaceOf(high, low));
          if (std::exchange(local_of[of_pair.back()], 0) < 0) of_chunk.push_back(of_pair.back());
          const std::size_t slot = chunks.slot[e];
          const auto turned = static_cast<unsigned>(nodes[a] < nodes[b]) << slot % kBlock;
          turned_[pairs_ * (slot / kBlock) + a * (a + 1) / 2 + b] |= static_cast<std::uint16_t>(turned);
          if (a == b || nodes[a] != nodes[b]) continue;
          doubled_.resize(turned_.size());
          doubled_[pairs_ * (slot / kBlock) + a * (a + 1) / 2 + b] |= static_cast<std::uint16_t>(1u << slot % kBlock);
        }
      }
    }
    FASCICLE_CHECK(of_chunk.size() <= UINT16_MAX + std::size_t{1}, "blocks of a chunk are numbered with 16 bits");
    std::sort(of_chunk.begin(), of_chunk.end());
    for (std::size_t i = 0; i < of_chunk.size(); ++i) local_of[of_chunk[i]] = static_cast<std::int32_t>(i);
    for (std::size_t slot = kBlock * chunk.block_begin; slot < kBlock * chunk.block_end; ++slot) {
      // Unused lanes of the last block repeat the last element.
      const std::size_t e = std::min(slot - kBlock * chunk.block_begin, chunk.tet_end - chunk.tet_begin - 1);
      for (std::size_t pair = 0; pair < pairs_; ++pair) {
        places_[(pairs_ * (slot / kBlock) + pair) * kBlock + slot % kBlock] =
            static_cast<std::uint16_t>(local_of[of_pair[pairs_ * e + pair]]);
      }
    }
    for (const std::int32_t place : of_chunk) local_of[place] = -1;
    all.insert(all.end(), of_chunk.begin(), of_chunk.end());
    begin_.push_back(all.size());
  }
  SetTargets(pattern, all);
}

// `blocks`: places of the lower triangle, for all chunks.
void StiffnessLayout::SetTargets(const BlockPattern& pattern, std::span<const std::int32_t> blocks) {
  std::vector<std::int32_t> number_of(pattern.blocks(), -1);
  std::vector<Target> lower;
  for (std::size_t row = 0; row < pattern.rows(); ++row) {
    for (std::int32_t k = pattern.begin[row]; k < pattern.begin[row + 1]; ++k) {
      if (static_cast<std::size_t>(pattern.column[k]) > row) break;
      number_of[k] = static_cast<std::int32_t>(lower.size());
      lower.push_back({k, pattern.PlaceOf(pattern.column[k], static_cast<std::int32_t>(row))});
    }
  }
  std::vector<std::int32_t> numbers;
  for (const std::int32_t place : blocks) numbers.push_back(number_of[place]);
  sharing_ = Sharing(numbers, lower.size());
  for (const std::int32_t target : sharing_.target) {
    targets_.push_back(target >= 0 ? lower[target] : Target{target, 0});
  }
  for (const std::int32_t number : sharing_.shared) shared_.push_back(lower[number]);
  sharing_.target = {};
}

}  // namespace fascicle
