#ifndef FASCICLE_CORE_LINALG_BLOCK_MATRIX_H_
#define FASCICLE_CORE_LINALG_BLOCK_MATRIX_H_

#include <array>
#include <cstdint>
#include <vector>

#include "core/linalg/nodal_vector.h"

namespace fascicle {

// Sparsity pattern of a matrix of 3x3 blocks: row i has blocks in columns column[begin[i] .. begin[i + 1]), ascending.
struct BlockPattern {
  std::vector<std::int32_t> begin = {0};
  std::vector<std::int32_t> column;

  std::size_t rows() const { return begin.size() - 1; }
  std::size_t blocks() const { return column.size(); }
  // Index of block (row, col), which must exist.
  std::int32_t PlaceOf(std::int32_t row, std::int32_t col) const;
};

// The pattern of a matrix that couples all nodes of each element; `nodes_of(e)` is a range of node numbers.
template <class NodesOf>
BlockPattern PatternOfElements(std::size_t nodes, std::size_t elements, const NodesOf& nodes_of);

// The transpose of a pattern with `columns` columns, and the index of each of its blocks in the original pattern.
struct TransposedPattern {
  TransposedPattern() = default;
  TransposedPattern(const BlockPattern& pattern, std::size_t columns);

  BlockPattern pattern;
  std::vector<std::int32_t> source;
};

// Values of the blocks of a pattern that is stored elsewhere.
using BlockValues = std::vector<Mat3>;

// product = A x for every row of the pattern. The same bits for any number of threads.
void Multiply(const BlockPattern& pattern, const BlockValues& values, const NodalVector& x, ThreadTeam& team,
              NodalVector& product);

// Which components of each node are unknown.
using FreeComponents = std::vector<std::array<bool, 3>>;

// Decouples prescribed components from all others: replaces their rows and columns by those of the identity.
void IsolatePrescribed(const BlockPattern& pattern, const FreeComponents& free, ThreadTeam& team, BlockValues& values);

// Builds a pattern row by row from unsorted columns with duplicates.
class PatternBuilder {
 public:
  void AddRow(std::vector<std::int32_t>& columns);     // leaves them sorted and unique
  BlockPattern Take() { return std::move(pattern_); }  // once, at the end

 private:
  BlockPattern pattern_;
  std::vector<std::int32_t> last_row_;  // the last row that had each column, counted from 1
};

template <class NodesOf>
BlockPattern PatternOfElements(std::size_t nodes, std::size_t elements, const NodesOf& nodes_of) {
  std::vector<std::int32_t> begin(nodes + 1, 0);
  for (std::size_t e = 0; e < elements; ++e) {
    for (const std::int32_t n : nodes_of(e)) ++begin[n + 1];
  }
  for (std::size_t n = 0; n < nodes; ++n) begin[n + 1] += begin[n];
  std::vector<std::int32_t> element(begin.back()), next(begin.begin(), begin.end() - 1);
  for (std::size_t e = 0; e < elements; ++e) {
    for (const std::int32_t n : nodes_of(e)) element[next[n]++] = static_cast<std::int32_t>(e);
  }
  PatternBuilder builder;
  std::vector<std::int32_t> columns;
  for (std::size_t n = 0; n < nodes; ++n) {
    columns.assign(1, static_cast<std::int32_t>(n));
    for (std::int32_t k = begin[n]; k < begin[n + 1]; ++k) {
      for (const std::int32_t other : nodes_of(element[k])) columns.push_back(other);
    }
    builder.AddRow(columns);
  }
  return builder.Take();
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_BLOCK_MATRIX_H_
