#ifndef FASCICLE_CORE_LINALG_MULTIPLIER_PRECONDITIONER_H_
#define FASCICLE_CORE_LINALG_MULTIPLIER_PRECONDITIONER_H_

#include <Eigen/SparseCholesky>

#include "core/linalg/active_set_qp.h"
#include "core/linalg/direct_solver.h"

namespace fascicle {

// An approximate inverse of G (diag M)^-1 G^T + C for the multipliers of a quadratic program. For volumes: the diagonal
// plus a correction for each block of `groups` (an additive two-level method). For all other rows: the matrix itself,
// factored. Symmetric and positive definite. Internal to this room.
class MultiplierPreconditioner {
 public:
  // G: rows of volumes first, then others. `regularization`: added to the diagonal of each row for which C is zero.
  // `team` shares the work; may be null.
  MultiplierPreconditioner(const QuadraticProgram& problem, const RowMatrix& G, Eigen::Index volumes,
                           const Eigen::VectorXd& inverse_mass, const Eigen::VectorXd& schur,
                           const Eigen::VectorXd& regularization, ThreadTeam* team);

  bool ok() const { return ok_; }
  // z = P r for all multipliers.
  void Apply(const Eigen::Ref<const Eigen::VectorXd>& r, Eigen::Ref<Eigen::VectorXd> z) const;

 private:
  Eigen::Index group_count() const { return static_cast<Eigen::Index>(members_.size()); }
  bool FactorGroups(const QuadraticProgram& problem, const RowMatrix& G, const Eigen::VectorXd& inverse_mass);
  bool FactorOthers(const RowMatrix& G, const Eigen::VectorXd& inverse_mass, const Eigen::VectorXd& regularization);

  Eigen::Index volumes_, others_;
  Eigen::VectorXd of_volumes_;
  std::vector<int> groups_;                         // of each volume
  std::vector<std::vector<Eigen::Index>> members_;  // of each group
  ThreadTeam* team_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> coarse_;
  mutable DirectSolver S_;  // solving does not change the factors
  bool ok_ = true;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_MULTIPLIER_PRECONDITIONER_H_
