#ifndef FASCICLE_CORE_LINALG_NODAL_VECTOR_H_
#define FASCICLE_CORE_LINALG_NODAL_VECTOR_H_

#include <vector>

#include "core/base/parallel.h"
#include "core/base/types.h"

namespace fascicle {

// Three components for each node: positions, velocities, forces.
using NodalVector = std::vector<Vec3>;

// Least number of nodes that a thread takes at a time.
inline constexpr std::size_t kNodeGrain = 2048;

// Calls body(n) for every node.
template <class Body>
void ForNodes(ThreadTeam& team, std::size_t nodes, const Body& body) {
  team.For(nodes, kNodeGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) body(n);
  });
}

// Sum of term(n) over the nodes, the same bits for any number of threads.
template <class Term>
double SumOverNodes(ThreadTeam& team, std::size_t nodes, const Term& term) {
  return team.Sum(nodes, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t n = begin; n < end; ++n) sum += term(n);
    return sum;
  });
}

inline double Dot(ThreadTeam& team, const NodalVector& a, const NodalVector& b) {
  return SumOverNodes(team, a.size(), [&](std::size_t n) { return a[n].dot(b[n]); });
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_NODAL_VECTOR_H_
