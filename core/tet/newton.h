#ifndef FASCICLE_CORE_TET_NEWTON_H_
#define FASCICLE_CORE_TET_NEWTON_H_

#include <memory>

#include "core/tet/newton_system.h"

namespace fascicle {

struct NewtonOptions {
  // For the force beyond its rounding error on each node, relative to the norm of all element forces.
  double tolerance = 1e-8;
  int max_iterations = 50;
  // Starts in place of x are taken if they are valid and have a smaller force. May be null:
  const NodalVector* guess = nullptr;
  // The solution before x. The start is extrapolated from both, pressures included, to `ahead` times their distance.
  const NodalVector* before = nullptr;
  double ahead = 0;
};

struct NewtonResult {
  enum class End { kConverged, kNotConverged, kInvalid };
  End end = End::kNotConverged;
  int iterations = 0;      // factorizations
  double residual = 0;     // largest |force| on an unknown component over the norm of all element forces [1]
  double force_scale = 0;  // that norm [N]
  std::size_t node = 0;    // the node where it occurs
  LinearSolves solves;
};

// Finds a stationary point of an IncrementalPotential, and a minimum if there is one nearby.
//
// Newton's method on positions and pressures (NewtonSystem). A step is shortened until it inverts no element and
// decreases the augmented Lagrangian
//   L(x) = Phi without patches + sum V_n [p'_n theta_n + rho_n/2 (theta_n - theta'_n)^2],   p' = p + dp,
// where theta' is the volume ratio that corresponds to p' to first order. The slope of L along dx is -dx.A dx - sum rho
// V dtheta^2, so L decreases wherever A is positive definite [Nocedal & Wright 2006, 18.3]. The exact tangent is tried
// first. If its inertia is not that of a minimum, it is blended with the projected tangent, as little as necessary,
// because the projected one is far stiffer and converges slowly. Prescribed components move in the first iterations;
// the rest of the body follows by the linear system. A start with inverted elements, or a prescribed motion that
// inverts some, is first repaired with UntanglingLaw. Not thread-safe; may throw Stopped (core/base/stop.h).
class NewtonSolver {
 public:
  // Model, team and profile must outlive the solver. Stages are timed in `profile`, which may be null.
  NewtonSolver(const TetModel& model, ThreadTeam& team, Profile* profile = nullptr);

  // x is the start and the result; its prescribed components move to those of `target`. The same for `pressure` (one
  // value for each patch). If the result is not kConverged, both are those of the last iteration.
  NewtonResult Solve(const IncrementalPotential& potential, const NodalVector& target, const NewtonOptions& options,
                     NodalVector& x, std::vector<double>& pressure);

 private:
  void Extrapolate(const IncrementalPotential& potential, const NodalVector& before, double ahead, NodalVector& x,
                   std::vector<double>& pressure);
  void StartNearer(const IncrementalPotential& potential, const NodalVector& guess,
                   const std::vector<double>& pressure_guess, NodalVector& x, std::vector<double>& pressure);
  double TakeStep(const IncrementalPotential& potential, double projection, bool same_point, bool prescribed_move,
                  NodalVector& x, std::vector<double>& pressure);
  bool TakeChordStep(const IncrementalPotential& potential, double residual, NodalVector& x,
                     std::vector<double>& pressure);
  bool Untangle(const NodalVector& target, NodalVector& x, NewtonResult& result);
  void Iterate(const IncrementalPotential& potential, const NodalVector& target, const NewtonOptions& options,
               NodalVector& x, std::vector<double>& pressure, NewtonResult& result);
  void Move(const NodalVector& x, double part);
  void PlacePrescribed(const NodalVector& target, NodalVector& x) const;
  void LookAhead(std::span<const double> pressure);
  double LineSearch(const IncrementalPotential& potential, const NodalVector& x, bool prescribed_move);
  double PatchMerit(std::span<const double> ratio, double augmentation) const;
  double SlopeAt(double augmentation) const;
  bool FindRemaining(const NodalVector& target, const NodalVector& x);
  double RelativeForce(const NewtonSystem::Evaluation& at, const NodalVector& force, NewtonResult& result) const;
  double PressureMiss(std::span<const double> pressure, double force_scale) const;

  const TetModel& model_;
  ThreadTeam& team_;
  NewtonSystem system_;
  NodalVector force_, trial_, trial_force_, dx_, remaining_;
  std::vector<double> dp_, pressure_ahead_, ratio_, ratio_ahead_;  // for each patch
  NewtonSystem::Evaluation now_, trial_now_;
  bool is_evaluated_ = false;  // whether now_ and force_ belong to the start of the next iteration
  double forcing_ = 0;         // tolerance of the next linear solve
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_NEWTON_H_
