#ifndef FASCICLE_CORE_TET_NEWTON_SYSTEM_H_
#define FASCICLE_CORE_TET_NEWTON_SYSTEM_H_

#include "core/base/profile.h"
#include "core/tet/saddle_solvers.h"

namespace fascicle {

// How the linear systems of one step in time were solved.
struct LinearSolves {
  int direct = 0, iterative = 0;  // number of systems
  int iterations = 0;             // of GMRES, all systems
  int not_converged = 0;          // iterative ones that were then factored
};

// The linear system of one Newton iteration on IncrementalPotential: SaddleMatrix with f the force -dPhi/dx with p in
// place of U'(theta),
//
//   [ A   B^T ] [dx]   [ f                ]
//   [ B   -C  ] [dp] = [ C (p - U'(theta)) ]
//
// Eliminating dp gives Newton's equation of Phi, but p is free to differ from U'(theta) on the way, which spares the
// stiff volume energy's detours. All bits are the same for any number of threads.
class NewtonSystem {
 public:
  // Finds the pattern; model and profile must outlive the system.
  explicit NewtonSystem(const TetModel& model, Profile* profile = nullptr);

  // Force f on all nodes (unknown and prescribed) and the merit function's parts at x with pressures p.
  struct Evaluation {
    double smallest_ratio = 1;   // least J of all points
    double rounding = 0;         // of the force of inertia, a small difference of positions times a large number [N]
    bool valid = false;          // J > 0 at all points, theta > 0, all finite
    double energy = 0;           // Phi without patches [J]
    double energy_rounding = 0;  // of elastic energies, small differences of larger terms [J]
    double force_scale = 0;      // norm of all element forces and loads [N]: what f is small against
  };
  Evaluation Evaluate(const IncrementalPotential& potential, const NodalVector& x, std::span<const double> pressure,
                      ThreadTeam& team, NodalVector& force);
  // theta of each patch at the x of the last Evaluate.
  const std::vector<double>& ratios() const { return forces_.ratio; }

  // How to solve.
  struct StepOptions {
    // In [0, 1]: the part of every point's tangent that its projection to a positive semidefinite one replaces.
    double projection = 0;
    double tolerance = 1e-3;  // of an iterative solution, relative to the right side
    bool same_point = false;  // x, pressure, force and prescribed are those of the last call
  };
  // The step from x and p, theta from the last Evaluate at that x: `force` as from there; `prescribed` the change of
  // prescribed components, which dx takes over. False when it is not a step towards a minimum: when the matrix can't be
  // factored or its inertia is not that of a minimum or, where it is solved iteratively, when its
  // Ritz values say so.
  bool FindStep(const IncrementalPotential& potential, const NodalVector& x, std::span<const double> pressure,
                const StepOptions& options, const NodalVector& force, const NodalVector& prescribed, ThreadTeam& team,
                NodalVector& dx, std::vector<double>& dp);

  // To be called before the first FindStep of a step in time: nothing of those before it is left, so that a run that
  // goes on from a checkpoint makes the same bits.
  void StartStep();

  // Has the systems of this step in time solved directly from here on. False when they are already, or too large.
  bool SolveDirectly();

  // How the linear systems since StartStep were solved.
  const LinearSolves& solves() const { return solves_; }

 private:
  void Smooth(const IncrementalPotential& potential, std::span<const double> pressure);

  const TetModel& model_;
  Profile* const profile_;
  SaddleAssembly assembly_;
  // The first that is needed of each.
  std::unique_ptr<DirectSaddleSolver> direct_;
  std::unique_ptr<IterativeSaddleSolver> iterative_;
  std::size_t unknowns_ = 0;
  bool prefers_iterative_ = false, is_iterative_ = false;
  ForceWorkspace forces_;
  double force_floor_ = 0;      // [N]
  double energy_rounding_ = 0;  // [J]
  std::vector<double> acting_;  // W p of each patch [Pa]
  void Assemble(const IncrementalPotential& potential, const NodalVector& x, std::span<const double> pressure,
                const NodalVector& force, const NodalVector& prescribed, ThreadTeam& team);
  void Project(const IncrementalPotential& potential, const NodalVector& x, double projection,
               const NodalVector& prescribed, ThreadTeam& team);
  bool Solve(double tolerance, ThreadTeam& team, NodalVector& dx, std::vector<double>& dp);

  double projection_ = 0;              // that is in the matrix
  bool has_projected_ = false;         // at this point
  NodalVector side_, projected_side_;  // right side, and what a whole projection takes from it [N]
  std::vector<double> volume_side_;    // [m^3]
  LinearSolves solves_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_NEWTON_SYSTEM_H_
