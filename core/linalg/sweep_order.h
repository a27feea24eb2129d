#ifndef FASCICLE_CORE_LINALG_SWEEP_ORDER_H_
#define FASCICLE_CORE_LINALG_SWEEP_ORDER_H_

#include <cstdint>
#include <span>
#include <vector>

#include "core/linalg/block_matrix.h"

namespace fascicle {

// The order in which Gauss-Seidel sweeps visit the rows of a matrix, such that threads can share the work and still get
// the same bits. Rows are cut into compact chunks, and chunks into colours: no two chunks of a colour are coupled, so
// their order does not matter. The colours follow each other.
struct SweepOrder {
  std::vector<std::int32_t> row;                 // at each place of the order
  std::vector<std::int32_t> place;               // of each row
  std::vector<std::int32_t> chunk_begin;         // places [chunk_begin[c], chunk_begin[c + 1]) are chunk c
  std::vector<std::int32_t> colour_begin = {0};  // the same for the chunks of each colour

  SweepOrder() = default;
  // `positions` of the rows [m]; only compactness depends on them. The pattern is symmetric.
  SweepOrder(const BlockPattern& pattern, std::span<const Vec3> positions);
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_SWEEP_ORDER_H_
