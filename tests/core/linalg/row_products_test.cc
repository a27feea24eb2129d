// Products and transposes of sparse rows against dense ones, by any number of threads.
#include "core/linalg/row_products.h"

#include <gtest/gtest.h>

#include <random>

namespace fascicle {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// With empty rows and columns.
RowMatrix RandomRows(int rows, int columns) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> place(0, columns - 1);
  std::normal_distribution<double> value;
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < i % 7; ++k) entries.emplace_back(i, place(random) / 2 * 2, value(random));
  }
  RowMatrix A(rows, columns);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

TEST(RowProducts, AreThoseOfDenseMatrices) {
  const RowMatrix A = RandomRows(2000, 900);
  const VectorXd x = VectorXd::LinSpaced(900, -1, 2);
  VectorXd alone, shared, scaled;
  Product(A, x, nullptr, alone);
  EXPECT_LT((alone - MatrixXd(A) * x).lpNorm<Eigen::Infinity>(), 1e-12);
  ThreadTeam team(3);
  Product(A, x, &team, shared);
  EXPECT_EQ(shared, alone);
  ProductWith(
      A, x, &team, [](Eigen::Index i, double sum) { return static_cast<double>(i) * sum; }, scaled);
  EXPECT_EQ(scaled, (alone.array() * VectorXd::LinSpaced(2000, 0, 1999).array().round()).matrix());
  EXPECT_NEAR(LargestTerms(A, x, &team), (MatrixXd(A).cwiseAbs() * x.cwiseAbs()).maxCoeff(), 1e-12);
}

TEST(RowProducts, TransposesHaveTheirEntriesInOrder) {
  for (const int threads : {0, 1, 3}) {
    std::unique_ptr<ThreadTeam> team = threads > 0 ? std::make_unique<ThreadTeam>(threads) : nullptr;
    for (const auto& [rows, columns] : {std::pair{700, 300}, {2, 5}, {1, 1}}) {
      const RowMatrix A = RandomRows(rows, columns), T = Transposed(A, team.get());
      EXPECT_EQ(MatrixXd(T), MatrixXd(A).transpose()) << threads;
      ASSERT_EQ(T.nonZeros(), A.nonZeros());
      for (Eigen::Index i = 0; i < T.rows(); ++i) {
        Eigen::Index last = -1;
        for (RowMatrix::InnerIterator entry(T, i); entry; ++entry) {
          EXPECT_GT(entry.col(), last);
          last = entry.col();
        }
      }
    }
  }
}

}  // namespace
}  // namespace fascicle
