#ifndef FASCICLE_CORE_LINALG_KKT_SYSTEM_H_
#define FASCICLE_CORE_LINALG_KKT_SYSTEM_H_

#include "core/linalg/active_set_qp.h"
#include "core/linalg/direct_solver.h"

namespace fascicle {

// The equations of a quadratic program with its active inequalities taken as equalities,
//   [ M   G^T ] [ v]   [p]
//   [ G   -C  ] [-y] = [b],    rows: volumes, equalities, active inequalities; C = E for volumes and zero elsewhere,
// solved as one symmetric system [Fan 2013, 5.3]. The factorization is that of a regularized system: a small multiple
// of the diagonal of G (diag M)^-1 G^T takes the place of the zeros of C, so that linearly dependent rows are harmless.
// Internal to this room.
class KktSystem {
 public:
  KktSystem(const QuadraticProgram& problem, const std::vector<bool>& active, ThreadTeam* team);

  // The solution v, and the multipliers y in the order of the rows.
  struct Result {
    bool ok = false;
    int iterations = 0;                        // of MINRES
    double stationarity = 0, feasibility = 0;  // of MINRES, as QpReport has them
    Eigen::VectorXd v, y;
  };
  // Solves the regularized system. Its multipliers are unique, so their signs tell which inequalities are to be active.
  Result SolveDirect();
  // Removes the regularization from the result by iterative refinement with the same factors. Call after SolveDirect.
  void RemoveRegularization(Result& result);
  Result SolveMinres(const QpSettings& settings) const;

  Eigen::Index size() const { return problem_->p.size() + b_.size(); }
  Eigen::Index volumes() const { return volumes_; }
  KktSystem(const KktSystem&) = delete;
  KktSystem& operator=(const KktSystem&) = delete;

 private:
  Eigen::VectorXd Side() const;
  // SolveWhole solves for v and y together; SolveMultipliers for y only, with v eliminated, where M is diagonal.
  Result SolveWhole(const QpSettings& settings) const;
  Result SolveMultipliers(const QpSettings& settings) const;
  // Whether forces balance and constraints hold to the tolerance; sets the residuals of the result.
  bool IsGood(Result& result, const QpSettings& settings) const;
  // Applies the system to x, with `scale` (0 or 1) times the regularization.
  void Apply(const Eigen::VectorXd& x, double scale, Eigen::VectorXd& y) const;
  // Iterative refinement with the factors.
  void Improve(double scale, Result& result);

  const QuadraticProgram* problem_;
  Eigen::Index volumes_;  // number of volume rows, which come first
  RowMatrix stacked_;     // all rows; empty where there are only volumes
  const RowMatrix* G_;    // m x n
  RowMatrix transposed_;  // G^T
  ThreadTeam* team_;      // shares the products; may be null
  Eigen::VectorXd b_;
  Eigen::VectorXd inverse_mass_;  // of diag M
  Eigen::VectorXd schur_;         // diagonal of G (diag M)^-1 G^T
  Eigen::VectorXd regularization_;
  DirectSolver factors_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_KKT_SYSTEM_H_
