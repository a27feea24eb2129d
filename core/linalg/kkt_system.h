#ifndef FASCICLE_CORE_LINALG_KKT_SYSTEM_H_
#define FASCICLE_CORE_LINALG_KKT_SYSTEM_H_

#include "core/linalg/active_set_qp.h"
#include "core/linalg/direct_solver.h"

namespace fascicle {

// The equations of a quadratic program whose active inequalities are equalities,
//   [ M   G^T ] [ v]   [p]
//   [ G   -C  ] [-y] = [b],    rows of volumes, equalities and active inequalities, C = E for volumes,
// C zero else, which are solved as one symmetric system [Fan 2013, 3.5]. Factors are of a system with a hair of the
// diagonal of G (diag M)^-1 G^T for that zero, so that rows that depend on others do no harm. For this room alone.
class KktSystem {
 public:
  KktSystem(const QuadraticProgram& problem, const std::vector<bool>& active, ThreadTeam* team);

  // Solutions v, and multipliers y of the rows in their order.
  struct Result {
    bool ok = false;
    int iterations = 0;                        // of MINRES
    double stationarity = 0, feasibility = 0;  // of MINRES, as QpReport has them
    Eigen::VectorXd v, y;
  };
  // With the hair for C: then multipliers are unique, and their signs tell which inequalities are to be active.
  Result SolveDirect();
  // What the hair took from the constraints comes back, by the same factors. After SolveDirect.
  void TakeOutHair(Result& result);
  Result SolveMinres(const QpSettings& settings) const;

  Eigen::Index size() const { return problem_->p.size() + b_.size(); }
  Eigen::Index volumes() const { return volumes_; }
  KktSystem(const KktSystem&) = delete;
  KktSystem& operator=(const KktSystem&) = delete;

 private:
  Eigen::VectorXd Side() const;
  // M v = p + G^T y together with its multipliers, and v of these alone, where M is diagonal.
  Result SolveWhole(const QpSettings& settings) const;
  Result SolveMultipliers(const QpSettings& settings) const;
  // Whether forces balance and constraints hold to a tolerance; sets how well they do.
  bool IsGood(Result& result, const QpSettings& settings) const;
  // hair_part: 1 with the hair, 0 without.
  void Apply(const Eigen::VectorXd& x, double hair_part, Eigen::VectorXd& y) const;
  // Refines a solution by the factors.
  void Improve(double hair_part, Result& result);

  const QuadraticProgram* problem_;
  Eigen::Index volumes_;  // the first rows
  RowMatrix stacked_;     // rows of more than volumes
  const RowMatrix* G_;    // m x n
  RowMatrix transposed_;  // G^T
  ThreadTeam* team_;      // shares the products, if there is one
  Eigen::VectorXd b_;
  Eigen::VectorXd inverse_mass_;  // of diag M
  Eigen::VectorXd schur_;         // diagonal of G (diag M)^-1 G^T
  Eigen::VectorXd hair_;
  DirectSolver factors_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_KKT_SYSTEM_H_
