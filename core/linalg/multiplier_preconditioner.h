#ifndef FASCICLE_CORE_LINALG_MULTIPLIER_PRECONDITIONER_H_
#define FASCICLE_CORE_LINALG_MULTIPLIER_PRECONDITIONER_H_

#include <Eigen/SparseCholesky>

#include "core/linalg/active_set_qp.h"
#include "core/linalg/direct_solver.h"

namespace fascicle {

// An approximate inverse of G (diag M)^-1 G^T + C for the multipliers of a quadratic program: of volumes the diagonal,
// corrected block by block of `groups` (their sum is an additive two-level method); of all other rows the matrix
// itself, factored. Symmetric and positive definite. For this room alone.
class MultiplierPreconditioner {
 public:
  // Shares the work with `team`, if there is one.
  // G: rows of volumes first, then others. `hair`: of each row, added to its diagonal where C has none.
  MultiplierPreconditioner(const QuadraticProgram& problem, const RowMatrix& G, Eigen::Index volumes,
                           const Eigen::VectorXd& inverse_mass, const Eigen::VectorXd& schur,
                           const Eigen::VectorXd& hair, ThreadTeam* team);

  bool ok() const { return ok_; }
  // z = P r, of all multipliers.
  void Apply(const Eigen::Ref<const Eigen::VectorXd>& r, Eigen::Ref<Eigen::VectorXd> z) const;

 private:
  Eigen::Index group_count() const { return static_cast<Eigen::Index>(members_.size()); }
  bool FactorGroups(const QuadraticProgram& problem, const RowMatrix& G, const Eigen::VectorXd& inverse_mass);
  bool FactorOthers(const RowMatrix& G, const Eigen::VectorXd& inverse_mass, const Eigen::VectorXd& hair);

  Eigen::Index volumes_, others_;
  Eigen::VectorXd of_volumes_;
  std::vector<int> groups_;                         // of each volume
  std::vector<std::vector<Eigen::Index>> members_;  // of each group
  ThreadTeam* team_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> coarse_;
  mutable DirectSolver S_;  // solving does not change its factors
  bool ok_ = true;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_MULTIPLIER_PRECONDITIONER_H_
