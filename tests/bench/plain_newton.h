#ifndef FASCICLE_TESTS_BENCH_PLAIN_NEWTON_H_
#define FASCICLE_TESTS_BENCH_PLAIN_NEWTON_H_

#include "cholmod_solver.h"

namespace fascicle::bench {

// A textbook quasi-static run: equal load steps; in each, Newton's method on positions with the exact tangent, one
// factorization per iteration, and a step that is halved until the energy decreases. One body without loads and with
// fixed supports.
class PlainNewton {
 public:
  // The model must outlive this. Analyzes the sparsity pattern.
  explicit PlainNewton(const TetModel& model);

  // Steps from activation `from` to `to` in equal load steps, each until the force on free nodes is below `tolerance`
  // times the norm of all element forces. False if it does not converge.
  bool Run(double from, double to, int steps, double tolerance);

  const NodalVector& positions() const { return x_; }
  // Of the elements on the nodes at the end [N].
  const NodalVector& force() const { return force_; }
  int iterations() const { return iterations_; }
  // The failed ones among them.
  int factorizations() const { return factorizations_; }
  const CholmodSolver& solver() const { return solver_; }

 private:
  bool Equilibrate(double activation, double tolerance);
  bool Factor(const FibreDrive& drive);
  bool Search(const FibreDrive& drive, const std::vector<double>& step);
  double EnergyAt(const FibreDrive& drive, const NodalVector& x);
  double NormOfFreeForce() const;

  const TetModel& model_;
  ThreadTeam team_{1};
  ForceWorkspace workspace_;
  CondensedMatrix matrix_;
  CholmodSolver solver_;
  NodalVector x_, trial_, force_;
  int iterations_ = 0;
  int factorizations_ = 0;
  double projection_ = 0;  // projected fraction of the last factored matrix's tangents
};

}  // namespace fascicle::bench

#endif  // FASCICLE_TESTS_BENCH_PLAIN_NEWTON_H_
