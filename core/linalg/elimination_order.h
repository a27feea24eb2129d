#ifndef FASCICLE_CORE_LINALG_ELIMINATION_ORDER_H_
#define FASCICLE_CORE_LINALG_ELIMINATION_ORDER_H_

#include <cstdint>
#include <span>
#include <vector>

namespace fascicle {

// A fill-reducing elimination order of the unknowns of a sparse symmetric matrix: nested dissection with minimum fill
// at the leaves, by SCOTCH [Pellegrini, Roman & Amestoy 2000]. Unknowns with the same neighbours, such as the
// components of a node, are one vertex of the dissected graph.
//
// Entries (rows[k], columns[k]) are off-diagonal ones of one triangle and any of the diagonal, counted from 0, without
// duplicates. Returns the position of each unknown in the order, from 0; nothing if memory runs out. The order depends
// only on the pattern: SCOTCH has a single thread and its own random numbers. Thread-safe; calls wait for each other.
std::vector<std::int32_t> EliminationOrder(std::int32_t size, std::span<const std::int32_t> rows,
                                           std::span<const std::int32_t> columns);

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_ELIMINATION_ORDER_H_
