#ifndef FASCICLE_TESTS_BENCH_CONDENSED_MATRIX_H_
#define FASCICLE_TESTS_BENCH_CONDENSED_MATRIX_H_

#include <cstdint>
#include <vector>

#include "core/tet/forces.h"

namespace fascicle::bench {

// The derivative -df/dx of the elastic force on all free nodes as one sparse symmetric matrix, with the pressures of
// patches eliminated:
//   K = A + B^T C^-1 B,   B = V_n dtheta_n/dx,   C = V_n / U''(theta_n),
// assembled element by element from the laws in the simplest way. For models whose nodes are free or supported in all
// three components, and whose patches are not smoothed (quadratic elements, or no patches).
class CondensedMatrix {
 public:
  explicit CondensedMatrix(const TetModel& model);

  struct Changes {
    double projection = 0;  // fraction of each tangent replaced by its nearest positive semidefinite one
    double inertia = 0;     // added to each node's diagonal, times its mass [1/s^2]
  };
  // Sets all values at positions x [m].
  void Assemble(const FibreDrive& drive, const NodalVector& x, const Changes& changes, ThreadTeam& team);

  // Norm of the forces of all elements on their nodes at the x of the last Assemble [N].
  double element_force_norm() const { return element_force_norm_; }

  // Free components, three for each free node in the model's order, and the inverse map; supported components are
  // unchanged.
  std::vector<double> ToComponents(const NodalVector& values) const;
  void AddComponents(const std::vector<double>& components, double part, NodalVector& values) const;

  // The lower triangle by columns, rows ascending.
  std::int32_t size() const { return 3 * free_nodes_; }
  const std::vector<std::int32_t>& column_begin() const { return column_begin_; }
  const std::vector<std::int32_t>& rows() const { return rows_; }
  const std::vector<double>& values() const { return values_; }

 private:
  template <class Element>
  void FindNeighbours();
  void SetPattern();
  template <class Element>
  void AddElements(const FibreDrive& drive, const NodalVector& x, double projection);
  void AddPatches();
  void AddBlock(std::int32_t row_node, std::int32_t column_node, const Mat3& block);

  const TetModel& model_;
  std::int32_t free_nodes_ = 0;
  std::vector<std::int32_t> unknown_;                  // of each node; -1: supported
  std::vector<std::vector<std::int32_t>> neighbours_;  // of each free node: itself and its later free neighbours
  std::vector<std::int32_t> column_begin_, rows_;
  std::vector<double> values_;
  ForceWorkspace workspace_;
  double element_force_norm_ = 0;
  std::vector<std::vector<std::int32_t>> patch_nodes_;  // free nodes on which each patch's volume depends, ascending
  std::vector<NodalVector> patch_gradients_;            // one row of B
};

}  // namespace fascicle::bench

#endif  // FASCICLE_TESTS_BENCH_CONDENSED_MATRIX_H_
