#ifndef FASCICLE_CORE_LINALG_ELIMINATION_ORDER_H_
#define FASCICLE_CORE_LINALG_ELIMINATION_ORDER_H_

#include <cstdint>
#include <span>
#include <vector>

namespace fascicle {

// An order in which to eliminate the unknowns of a sparse symmetric matrix that keeps its factors sparse: nested
// dissection with minimum fill at the leaves, by SCOTCH [Pellegrini, Roman & Amestoy 2000]. Unknowns with the same
// neighbours, such as the components of a node, are one vertex of the dissected graph.
//
// The entries (rows[k], columns[k]) are off-diagonal ones of one triangle and any of the diagonal, counted from 0, none
// twice. Returns for each unknown its place in the order, from 0; nothing when memory runs out. The order depends on
// the pattern alone: SCOTCH gets a single thread and random numbers of its own. Thread-safe; calls wait for each other.
std::vector<std::int32_t> EliminationOrder(std::int32_t size, std::span<const std::int32_t> rows,
                                           std::span<const std::int32_t> columns);

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_ELIMINATION_ORDER_H_
