#include "core/linalg/block_matrix.h"

#include <algorithm>
#include <utility>

namespace fascicle {

std::int32_t BlockPattern::PlaceOf(std::int32_t row, std::int32_t col) const {
  const auto first = column.begin() + begin[row], last = column.begin() + begin[row + 1];
  return static_cast<std::int32_t>(std::lower_bound(first, last, col) - column.begin());
}

TransposedPattern::TransposedPattern(const BlockPattern& of, std::size_t columns) : source(of.blocks()) {
  pattern.begin.assign(columns + 1, 0);
  pattern.column.resize(of.blocks());
  for (const std::int32_t c : of.column) ++pattern.begin[c + 1];
  for (std::size_t c = 0; c < columns; ++c) pattern.begin[c + 1] += pattern.begin[c];
  std::vector<std::int32_t> next(pattern.begin.begin(), pattern.begin.end() - 1);
  for (std::size_t row = 0; row < of.rows(); ++row) {
    for (std::int32_t k = of.begin[row]; k < of.begin[row + 1]; ++k) {
      const std::int32_t place = next[of.column[k]]++;
      pattern.column[place] = static_cast<std::int32_t>(row);
      source[place] = k;
    }
  }
}

void Multiply(const BlockPattern& pattern, const BlockValues& values, const NodalVector& x, ThreadTeam& team,
              NodalVector& product) {
  product.resize(pattern.rows());
  ForNodes(team, pattern.rows(), [&](std::size_t i) {
    Vec3 sum = Vec3::Zero();
    for (std::int32_t k = pattern.begin[i]; k < pattern.begin[i + 1]; ++k) sum += values[k] * x[pattern.column[k]];
    product[i] = sum;
  });
}

void IsolatePrescribed(const BlockPattern& pattern, const FreeComponents& free, ThreadTeam& team, BlockValues& values) {
  ForNodes(team, pattern.rows(), [&](std::size_t row) {
    for (std::int32_t k = pattern.begin[row]; k < pattern.begin[row + 1]; ++k) {
      const std::size_t col = pattern.column[k];
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          if (!free[row][i] || !free[col][j]) values[k](i, j) = row == col && i == j ? 1 : 0;
        }
      }
    }
  });
}

void PatternBuilder::AddRow(std::vector<std::int32_t>& columns) {
  // Duplicates are removed before sorting: a column may occur ten times, and sorting all of them would take most of the
  // time.
  const auto row = static_cast<std::int32_t>(pattern_.begin.size());
  std::erase_if(columns, [&](std::int32_t column) {
    if (column >= static_cast<std::int32_t>(last_row_.size())) last_row_.resize(column + 1, 0);
    return std::exchange(last_row_[column], row) == row;
  });
  std::sort(columns.begin(), columns.end());
  pattern_.column.insert(pattern_.column.end(), columns.begin(), columns.end());
  pattern_.begin.push_back(static_cast<std::int32_t>(pattern_.column.size()));
}

}  // namespace fascicle
