#ifndef FASCICLE_CORE_EULERIAN_VELOCITY_PROGRAM_H_
#define FASCICLE_CORE_EULERIAN_VELOCITY_PROGRAM_H_

#include <memory>
#include <vector>

#include "core/eulerian/forces.h"
#include "core/linalg/active_set_qp.h"

namespace fascicle {

// The velocities of all bodies at the end of a step as one quadratic program [Fan 2013, 3.2, 3.11]:
//
//   v = argmin 1/2 (v - v*) . M (v - v*)          M + dt^2 K for the first M where elasticity is implicit
//   where  sum over nodes of V grad N . v + eps L p = V (1 - J)/(dt J), or 0      for each block of cells
//
// and prescribed nodes move as their supports do. Blocks of cells (cell_blocks.h) share a pressure p. Each body has its
// own columns, three for each free node, and its own rows; no row couples two bodies. Not thread-safe; may end by
// Stopped.
class VelocityProgram {
 public:
  // What a body brings. All of it must stay as it is until the velocities are taken.
  struct Part {
    const EulerianBody* body;
    const EulerianState* state;
    const BodyControls* controls;
    const EulerianCells* cells;
    const NodeRoles* roles;
    const NodalForces* forces;
    const std::vector<Vec3>* velocity;  // of each node: v* where it is free, as prescribed where it is prescribed
    double waves;                       // the step that the fastest wave of the body would allow [s]
  };

  // dt: the length of the step [s].
  VelocityProgram(double dt, ThreadTeam& team);
  ~VelocityProgram();

  // Bodies are numbered from 0 as they are added.
  void AddBody(const Part& part);
  // Once, after all bodies. iterations(): of MINRES.
  QpStatus Solve();
  int iterations() const;

  // After QpStatus::kSolved.
  //   velocity  of free nodes: set; others stay
  //   pressure  of each cell: set in those of blocks, in the mean of the step, compression positive [Pa]
  //   impulses  of each prescribed node: what volumes and implicit elasticity push it with is taken off [N s]; empty
  //             for a body without supports
  void TakeBody(std::size_t body, std::vector<Vec3>& velocity, std::vector<double>& pressure,
                std::vector<Vec3>& impulses) const;

 private:
  struct Block;  // of a body
  void SetMasses(QuadraticProgram& problem) const;
  void SetVolumes(QuadraticProgram& problem) const;
  void SetStabilization(QuadraticProgram& problem) const;
  void SetGroups(QuadraticProgram& problem) const;
  void SetStiffness(QuadraticProgram& problem);

  double dt_;
  ThreadTeam& team_;
  std::vector<std::unique_ptr<Block>> blocks_;
  int nodes_ = 0, rows_ = 0;  // of all bodies: free nodes, rows of volumes
  QpSolution solution_;
  int iterations_ = 0;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_VELOCITY_PROGRAM_H_
