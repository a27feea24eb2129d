#include "core/linalg/elimination_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <thread>

namespace fascicle {
namespace {

// The lower triangle's pattern of a grid of n^3 nodes with three components each, every node coupled to its 26
// neighbours.
struct Grid {
  explicit Grid(int n) : size(3 * n * n * n) {
    const auto node = [n](int i, int j, int k) { return i + n * (j + n * k); };
    const auto join = [this](int a, int b) {
      for (int c = 0; c < 3; ++c) {
        for (int d = 0; d < (a == b ? c + 1 : 3); ++d) {
          rows.push_back(3 * a + c);
          columns.push_back(3 * b + d);
        }
      }
    };
    for (int k = 0; k < n; ++k) {
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
          for (int step = 0; step < 27; ++step) {
            const std::array<int, 3> to = {i + step % 3 - 1, j + step / 3 % 3 - 1, k + step / 9 - 1};
            if (std::any_of(to.begin(), to.end(), [n](int t) { return t < 0 || t >= n; })) continue;
            if (node(to[0], to[1], to[2]) <= node(i, j, k)) join(node(i, j, k), node(to[0], to[1], to[2]));
          }
        }
      }
    }
  }

  std::int32_t size;
  std::vector<std::int32_t> rows, columns;
};

std::vector<std::int32_t> Identity(std::int32_t size) {
  std::vector<std::int32_t> order(size);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

// Number of entries of the factor L for an elimination order, by symbolic elimination.
std::size_t EntriesOfFactor(const Grid& grid, const std::vector<std::int32_t>& order) {
  std::vector<std::vector<std::int32_t>> below(grid.size);  // of each column, ascending
  for (std::size_t k = 0; k < grid.rows.size(); ++k) {
    const auto [first, last] = std::minmax(order[grid.rows[k]], order[grid.columns[k]]);
    if (first != last) below[first].push_back(last);
  }
  std::size_t entries = 0;
  for (std::vector<std::int32_t>& column : below) {
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    entries += column.size() + 1;
    if (column.empty()) continue;
    // The remaining unknowns of this column become coupled; the next of them represents this.
    std::vector<std::int32_t>& next = below[column.front()];
    next.insert(next.end(), column.begin() + 1, column.end());
    std::vector<std::int32_t>().swap(column);
  }
  return entries;
}

TEST(EliminationOrderTest, IsAPermutationThatKeepsFactorsSparse) {
  const Grid grid(11);
  std::vector<std::int32_t> order = EliminationOrder(grid.size, grid.rows, grid.columns);
  ASSERT_EQ(order.size(), static_cast<std::size_t>(grid.size));
  EXPECT_LT(EntriesOfFactor(grid, order), 0.6 * static_cast<double>(EntriesOfFactor(grid, Identity(grid.size))));
  for (std::size_t i = 0; i < order.size(); i += 3) {
    EXPECT_EQ(order[i + 1], order[i] + 1) << "components of a node stay together";
    EXPECT_EQ(order[i + 2], order[i] + 2);
  }
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, Identity(grid.size));
}

TEST(EliminationOrderTest, DependsOnThePatternAlone) {
  const Grid grid(9), other(5);
  const std::vector<std::int32_t> first = EliminationOrder(grid.size, grid.rows, grid.columns);
  std::vector<std::vector<std::int32_t>> orders(4);
  {
    std::vector<std::jthread> threads;
    for (std::vector<std::int32_t>& order : orders) {
      threads.emplace_back([&] {
        EliminationOrder(other.size, other.rows, other.columns);
        order = EliminationOrder(grid.size, grid.rows, grid.columns);
      });
    }
  }
  for (const std::vector<std::int32_t>& order : orders) EXPECT_EQ(order, first);
}

TEST(EliminationOrderTest, TakesUnknownsWithoutNeighbours) {
  const std::vector<std::int32_t> one = {0};
  EXPECT_EQ(EliminationOrder(1, one, one), one);
  std::vector<std::int32_t> diagonal = Identity(200);
  std::vector<std::int32_t> order = EliminationOrder(200, diagonal, diagonal);
  std::sort(order.begin(), order.end());
  EXPECT_EQ(order, diagonal);
}

}  // namespace
}  // namespace fascicle
