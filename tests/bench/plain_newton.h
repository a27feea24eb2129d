#ifndef FASCICLE_TESTS_BENCH_PLAIN_NEWTON_H_
#define FASCICLE_TESTS_BENCH_PLAIN_NEWTON_H_

#include "cholmod_solver.h"

namespace fascicle::bench {

// A quasi-static run as textbooks have it: load steps of equal size, in each Newton's method on positions alone with
// the exact tangent, one factorization an iteration, and a step that is halved until the energy falls. One body without
// loads, supports at rest.
class PlainNewton {
 public:
  // The model must outlive this. Finds the pattern and has it analyzed.
  explicit PlainNewton(const TetModel& model);

  // From activation `from` to `to` in so many steps, each until the force on free nodes is below `tolerance` of the
  // norm of all element forces. False where it does not converge.
  bool Run(double from, double to, int steps, double tolerance);

  const NodalVector& positions() const { return x_; }
  // Of the elements on the nodes at the end [N].
  const NodalVector& force() const { return force_; }
  int iterations() const { return iterations_; }
  // Those that failed among them.
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
  double projection_ = 0;  // part of the last factored matrix's tangents
};

}  // namespace fascicle::bench

#endif  // FASCICLE_TESTS_BENCH_PLAIN_NEWTON_H_
