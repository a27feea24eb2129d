#ifndef FASCICLE_CORE_LINALG_ROW_PRODUCTS_H_
#define FASCICLE_CORE_LINALG_ROW_PRODUCTS_H_

#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"

namespace fascicle {

using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
inline constexpr std::size_t kRowGrain = 512;  // rows that a thread takes at a time

// Calls body(begin, end) on ranges of [0, count): in parallel if there is a team, otherwise once for the whole range.
template <class Body>
void InRanges(ThreadTeam* team, std::size_t count, std::size_t grain, const Body& body) {
  team != nullptr ? team->For(count, grain, body) : body(0, count);
}

// y_i = value(i, (A x)_i), with the rows shared by the team, if there is one. Results have the same bits without it.
template <class Value>
void ProductWith(const RowMatrix& A, const Eigen::Ref<const Eigen::VectorXd>& x, ThreadTeam* team, const Value& value,
                 Eigen::VectorXd& y) {
  y.resize(A.rows());
  const auto rows = [&](std::size_t begin, std::size_t end) {
    for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i) {
      double sum = 0;
      for (RowMatrix::InnerIterator entry(A, i); entry; ++entry) sum += entry.value() * x[entry.col()];
      y[i] = value(i, sum);
    }
  };
  InRanges(team, static_cast<std::size_t>(A.rows()), kRowGrain, rows);
}

// y = A x.
inline void Product(const RowMatrix& A, const Eigen::Ref<const Eigen::VectorXd>& x, ThreadTeam* team,
                    Eigen::VectorXd& y) {
  ProductWith(
      A, x, team, [](Eigen::Index, double sum) { return sum; }, y);
}

// max_i sum_j |A_ij x_j|: the magnitude of the terms of a set of constraints.
inline double LargestTerms(const RowMatrix& A, const Eigen::VectorXd& x, ThreadTeam* team) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(A.rows());
  const auto rows = [&](std::size_t begin, std::size_t end) {
    for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i) {
      for (RowMatrix::InnerIterator entry(A, i); entry; ++entry) sums[i] += std::abs(entry.value() * x[entry.col()]);
    }
  };
  InRanges(team, static_cast<std::size_t>(A.rows()), kRowGrain, rows);
  return sums.size() == 0 ? 0 : sums.maxCoeff();
}

// A^T. The entries of each row keep the order of A's rows. Shared by the team, if there is one.
RowMatrix Transposed(const RowMatrix& A, ThreadTeam* team);

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_ROW_PRODUCTS_H_
