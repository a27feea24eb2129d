#ifndef FASCICLE_CORE_TET_NEWTON_H_
#define FASCICLE_CORE_TET_NEWTON_H_

#include <memory>
#include <stop_token>

#include "core/tet/newton_system.h"

namespace fascicle {

struct NewtonOptions {
  double tolerance = 1e-8;  // of the force, relative to the norm of all element forces
  int max_iterations = 50;
  std::stop_token stop;  // looked at before every iteration
};

struct NewtonResult {
  enum class End { kConverged, kNotConverged, kInvalid, kStopped };
  End end = End::kNotConverged;
  int iterations = 0;    // factorizations
  double residual = 0;   // largest |force| on an unknown component over the norm of all element forces [1]
  std::size_t node = 0;  // where
  LinearSolves solves;
};

// Finds a stationary point of an IncrementalPotential, a minimum wherever there is one nearby.
//
// Newton's method on positions and pressures (NewtonSystem). A step is cut until it leaves no element inverted and
// lowers the augmented Lagrangian
//   L(x) = Phi without patches + sum V_n [p'_n theta_n + rho_n/2 (theta_n - theta'_n)^2],   p' = p + dp,
// theta' the volume ratio that goes with p' to first order: its slope along dx is -dx.A dx - sum rho V dtheta^2, so it
// falls wherever A is positive definite [Nocedal & Wright 2006, 18.3]. The exact tangent comes first; where its
// inertia is not that of a minimum, it is moved towards the projected one, no further than it takes: that one alone is
// far stiffer, and creeps. Components that are prescribed move with the first iterations, as the linear system says the
// rest of the body would follow. A start with inverted elements, or a prescribed motion that inverts some, is first
// brought in order with UntanglingLaw. One thread at a time.
class NewtonSolver {
 public:
  // Model, team and profile must outlive the solver. Stages are timed in `profile` where there is one.
  NewtonSolver(const TetModel& model, ThreadTeam& team, Profile* profile = nullptr);

  // x is where to start and the result; its prescribed components go to those of `target`. `pressure` likewise (one for
  // each patch). On anything but kConverged both are where the iteration ended.
  NewtonResult Solve(const IncrementalPotential& potential, const NodalVector& target, const NewtonOptions& options,
                     NodalVector& x, std::vector<double>& pressure);

  // To be called before Solve: x becomes `guess` where that is nearer to a solution, that is valid with a smaller
  // force.
  void StartNearer(const IncrementalPotential& potential, const NodalVector& guess, std::span<const double> pressure,
                   NodalVector& x);

 private:
  double TakeStep(const IncrementalPotential& potential, double projection, bool same_point, bool prescribed_move,
                  NodalVector& x, std::vector<double>& pressure);
  bool Untangle(const NodalVector& target, const std::stop_token& stop, NodalVector& x, NewtonResult& result);
  void Iterate(const IncrementalPotential& potential, const NodalVector& target, const NewtonOptions& options,
               NodalVector& x, std::vector<double>& pressure, NewtonResult& result);
  void Move(const NodalVector& x, double part);
  void PlacePrescribed(const NodalVector& target, NodalVector& x) const;
  void LookAhead(std::span<const double> pressure);
  double LineSearch(const IncrementalPotential& potential, const NodalVector& x, bool prescribed_move);
  double PatchMerit(std::span<const double> ratio, double augmentation) const;
  double SlopeAt(double augmentation) const;
  bool FindRemaining(const NodalVector& target, const NodalVector& x);
  double RelativeForce(NewtonResult& result) const;
  void ChooseForcing(double residual, double residual_before, double tolerance);
  bool PressuresAgree(std::span<const double> pressure, double tolerance) const;

  const TetModel& model_;
  ThreadTeam& team_;
  NewtonSystem system_;
  NodalVector force_, trial_, trial_force_, dx_, remaining_;
  std::vector<double> dp_, pressure_ahead_, ratio_, ratio_ahead_;  // of each patch
  NewtonSystem::Evaluation now_, trial_now_;
  bool is_evaluated_ = false;  // now_ and force_ are those of where the next iteration starts
  double forcing_ = 0;         // tolerance of the next linear solution
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_NEWTON_H_
