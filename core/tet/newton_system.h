#ifndef FASCICLE_CORE_TET_NEWTON_SYSTEM_H_
#define FASCICLE_CORE_TET_NEWTON_SYSTEM_H_

#include <stop_token>

#include "core/base/profile.h"
#include "core/tet/contact.h"
#include "core/tet/saddle_solvers.h"

namespace fascicle {

// Statistics of the linear solves of one time step.
struct LinearSolves {
  int direct = 0, iterative = 0;  // number of systems
  int iterations = 0;             // of GMRES, over all systems
  int not_converged = 0;          // iterative solves that failed and were factored
};

// The linear system of one Newton iteration on IncrementalPotential: a SaddleMatrix, with f the force -dPhi/dx where p
// replaces U'(theta),
//
//   [ A   B^T ] [dx]   [ f                ]
//   [ B   -C  ] [dp] = [ C (p - U'(theta)) ]
//
// Eliminating dp gives Newton's equation of Phi. But during the iteration p may differ from U'(theta), which avoids the
// long path along the stiff volume energy. The same bits for any number of threads.
class NewtonSystem {
 public:
  // Finds the sparsity pattern. Model and profile must outlive the system.
  explicit NewtonSystem(const TetModel& model, Profile* profile = nullptr, const std::stop_token& stop = {});

  // Force f on all nodes (unknown and prescribed) and the terms of the merit function at x with pressures p.
  struct Evaluation {
    double smallest_ratio = 1;   // least J of all points
    double rounding = 0;         // rounding error of the inertia force [N]
    bool valid = false;          // whether J > 0 at all points, theta > 0, and everything is finite
    double energy = 0;           // Phi without patches [J]
    double energy_rounding = 0;  // rounding error of the elastic energies, small differences of larger terms [J]
    double force_scale = 0;      // norm of all element forces and loads [N], the scale for f
  };
  Evaluation Evaluate(const IncrementalPotential& potential, const NodalVector& x, std::span<const double> pressure,
                      ThreadTeam& team, NodalVector& force);
  // Rounding error of the elastic force on each node [N].
  const std::vector<double>& force_rounding() const { return force_rounding_; }
  // theta of each patch at the x of the last Evaluate.
  const std::vector<double>& ratios() const { return forces_.ratio; }

  // How to solve for a step.
  struct StepOptions {
    // In [0, 1]: degree of blending every point's tangent with its projection to a positive semidefinite one.
    double projection = 0;
    double tolerance = 1e-3;  // of an iterative solve, relative to the right-hand side
    bool same_point = false;  // whether x, pressure, force and prescribed are those of the last call
  };
  // The step from x and p, with theta and `force` from the last Evaluate at that x. `prescribed` is the change of
  // prescribed components, which dx adopts. False if it is not a step towards a minimum: the matrix can't be factored,
  // its inertia is not that of a minimum or, for iterative solves, its Ritz values show that.
  bool FindStep(const IncrementalPotential& potential, const NodalVector& x, std::span<const double> pressure,
                const StepOptions& options, const NodalVector& force, const NodalVector& prescribed, ThreadTeam& team,
                NodalVector& dx, std::vector<double>& dp);

  // A step with the matrix of the last FindStep, which was successful and for another x: a chord step, without assembly
  // and set-up. Prescribed components stay. False if an iterative solve fails.
  bool FindChordStep(const IncrementalPotential& potential, std::span<const double> pressure, double tolerance,
                     const NodalVector& force, ThreadTeam& team, NodalVector& dx, std::vector<double>& dp);

  // dp . B dx: the work of the change of pressures, by the matrix of the last FindStep [J].
  double WorkOfPressures(const NodalVector& dx, std::span<const double> dp, ThreadTeam& team) const;

  // Call before the first FindStep of a time step. Discards everything from earlier steps, so that a run resumed from a
  // checkpoint has the same bits.
  void StartStep();

  // Switches to direct solves for the rest of this time step. False if that is already so, or if the systems are too
  // large.
  bool SolveDirectly();

  // Statistics of the linear solves since StartStep.
  const LinearSolves& solves() const { return solves_; }

 private:
  void Smooth(const IncrementalPotential& potential, std::span<const double> pressure);

  const TetModel& model_;
  Profile* const profile_;
  SaddleAssembly assembly_;
  // Each is created when it is first needed.
  std::unique_ptr<DirectSaddleSolver> direct_;
  std::unique_ptr<IterativeSaddleSolver> iterative_;
  std::size_t unknowns_ = 0;
  bool prefers_iterative_ = false, is_iterative_ = false;
  ForceWorkspace forces_;
  double force_floor_ = 0;  // [N]
  std::vector<double> force_rounding_;
  double energy_rounding_ = 0;   // [J]
  std::vector<double> acting_;   // W p for each patch [Pa]
  NodalVector expansion_force_;  // of LoadExpansion [N]
  ContactSearch contact_;        // at the x of the last Evaluate
  void Assemble(const IncrementalPotential& potential, const NodalVector& x, std::span<const double> pressure,
                const NodalVector& force, const NodalVector& prescribed, ThreadTeam& team);
  void SetSide(const IncrementalPotential& potential, std::span<const double> pressure, const NodalVector& force,
               ThreadTeam& team);
  void Project(const IncrementalPotential& potential, const NodalVector& x, double projection,
               const NodalVector& prescribed, ThreadTeam& team);
  // What touches at the x of the last Evaluate.
  std::span<const Touch> TouchesOf(const IncrementalPotential& potential) const;
  bool Solve(double tolerance, ThreadTeam& team, NodalVector& dx, std::vector<double>& dp);

  bool direct_is_current_ = false, iterative_is_current_ = false;  // whether the solvers have taken the matrix
  double projection_ = 0;                                          // degree of projection of the current matrix
  bool has_projected_ = false;                                     // whether the projection at this point is assembled
  NodalVector side_, projected_side_;  // right-hand side, and the change by complete projection [N]
  std::vector<double> volume_side_;    // [m^3]
  LinearSolves solves_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_NEWTON_SYSTEM_H_
