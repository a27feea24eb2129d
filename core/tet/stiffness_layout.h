#ifndef FASCICLE_CORE_TET_STIFFNESS_LAYOUT_H_
#define FASCICLE_CORE_TET_STIFFNESS_LAYOUT_H_

#include "core/linalg/block_matrix.h"
#include "core/tet/model.h"

namespace fascicle {

// Where the 3x3 blocks of the element matrices go in the symmetric matrix of all nodes; like Sharing for forces, chunk
// by chunk. A chunk adds up the blocks of the lower triangle to which its elements contribute. Blocks of a single chunk
// go to their places in both triangles; the others go to slots, which are added up in the order of the chunks.
class StiffnessLayout {
 public:
  // The pattern couples all nodes of each element.
  StiffnessLayout(const TetModel& model, const BlockPattern& pattern, const std::stop_token& stop = {});

  // Places of a block and its transpose in the pattern; if several chunks share the block, low = ~slot.
  struct Target {
    std::int32_t low = 0, high = 0;
  };
  // The targets of the blocks of chunk c.
  std::span<const Target> TargetsOf(std::size_t c) const {
    return std::span(targets_).subspan(begin_[c], begin_[c + 1] - begin_[c]);
  }
  // The places of an element's pairs of nodes, in the layout of ChunkBlocks, starting at block b of all blocks.
  const std::uint16_t* PlacesOf(std::size_t b) const { return &places_[pairs_ * kBlock * b]; }
  const std::uint16_t* TurnedOf(std::size_t b) const { return &turned_[pairs_ * b]; }
  const std::uint16_t* DoubledOf(std::size_t b) const { return doubled_.empty() ? nullptr : &doubled_[pairs_ * b]; }

  // Blocks of the lower triangle that several chunks share, or that have none: the slots of shared()[i] are
  // slots()[slot_begin()[i] .. slot_begin()[i + 1]).
  const std::vector<Target>& shared() const { return shared_; }
  const std::vector<std::int32_t>& slot_begin() const { return sharing_.begin; }
  const std::vector<std::int32_t>& slots() const { return sharing_.slots; }

 private:
  template <class Element>
  void SetPlaces(const TetModel& model, const BlockPattern& pattern, const std::stop_token& stop);
  void SetTargets(const BlockPattern& pattern, std::span<const std::int32_t> blocks);

  std::size_t pairs_ = 0;  // number of node pairs of an element
  std::vector<std::size_t> begin_ = {0};
  std::vector<Target> targets_, shared_;
  std::vector<std::uint16_t> places_, turned_;
  std::vector<std::uint16_t> doubled_;  // empty without collapsed elements
  Sharing sharing_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_STIFFNESS_LAYOUT_H_
