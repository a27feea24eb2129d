#ifndef FASCICLE_CORE_LINALG_LOWER_TRIANGLE_H_
#define FASCICLE_CORE_LINALG_LOWER_TRIANGLE_H_

#include <Eigen/SparseCore>

#include <cstdint>
#include <vector>

#include "core/linalg/direct_solver.h"

namespace fascicle {

// Entries of the lower triangle of a symmetric matrix, for a DirectSolver.
struct LowerTriangle {
  void Add(Eigen::Index row, Eigen::Index column, double value) {
    rows.push_back(static_cast<std::int32_t>(row));
    columns.push_back(static_cast<std::int32_t>(column));
    values.push_back(value);
  }
  // Adds `factor` times a matrix whose first row and column are row and column `first` of this one.
  void Add(const Eigen::SparseMatrix<double>& matrix, Eigen::Index first, double factor) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, column); entry; ++entry) {
        if (entry.row() >= column) Add(first + entry.row(), first + column, factor * entry.value());
      }
    }
  }
  bool Factor(Eigen::Index size, DirectSolver& solver) const {
    return solver.Analyze(static_cast<std::int32_t>(size), rows, columns) && solver.Factor(values).ok;
  }

  std::vector<std::int32_t> rows, columns;
  std::vector<double> values;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_LOWER_TRIANGLE_H_
