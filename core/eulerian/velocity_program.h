#ifndef FASCICLE_CORE_EULERIAN_VELOCITY_PROGRAM_H_
#define FASCICLE_CORE_EULERIAN_VELOCITY_PROGRAM_H_

#include <memory>
#include <vector>

#include "core/eulerian/contact_row.h"
#include "core/eulerian/momentum.h"
#include "core/linalg/active_set_qp.h"

namespace fascicle {

// The velocities of all bodies at the end of a step as one quadratic program [Fan 2013, eq. 3.11 and section 3.3]:
//
//   v = argmin 1/2 (v - v*) . M (v - v*)     with M + dt^2 K in place of the first M if elasticity is implicit
//   where  sum over nodes of V grad N . v + eps L p = V (1 - J)/(dt J), or 0      for each block of cells
//          w >= least                                                             for each row of contact
//
// with prescribed velocities of supported nodes. Blocks of cells (cell_blocks.h) share a pressure p. Each body has its
// own columns, three for each free node, and its own rows of volumes; only rows of contact (contact_row.h) couple
// bodies. Not thread-safe. May throw Stopped.
class VelocityProgram {
 public:
  // The data of a body, which must not change until its velocities have been taken.
  struct Part {
    const EulerianBody* body;
    const EulerianState* state;
    const BodyControls* controls;
    const EulerianCells* cells;
    const NodeRoles* roles;
    const NodalForces* forces;
    const std::vector<Vec3>* velocity;  // for each node: v* if it is free, its prescribed velocity if it is prescribed
    double waves;                       // the step allowed by the fastest wave of the body [s]
  };

  // dt: the length of the step [s].
  VelocityProgram(double dt, ThreadTeam& team);
  ~VelocityProgram();

  // Bodies are numbered from 0 in the order of the calls.
  void AddBody(const Part& part);
  // Bodies of the row as numbered here. A row without free nodes, or whose normals cancel, is ignored.
  void AddContact(ContactRow row);
  // Call once, after all bodies and contacts. iterations() counts those of MINRES.
  QpStatus Solve();
  int iterations() const;
  // The largest residual of QpReport [1].
  double residual() const;

  // Call after QpStatus::kSolved.
  //   velocity  set for free nodes; others are unchanged
  //   pressure  set for each cell of a block: the mean over the step, compression positive [Pa]
  //   impulses  for each prescribed node: the impulse of constraints and implicit elasticity on it is subtracted [N s];
  //             empty for a body without supports
  void TakeBody(std::size_t body, std::vector<Vec3>& velocity, std::vector<double>& pressure,
                std::vector<Vec3>& impulses) const;
  // The impulse of all contacts on a body, and its moment about the origin, in its grid's frame [N s, N m s].
  Resultant ContactImpulse(std::size_t body) const;
  // Adds the impulse of each floor on all bodies, in the world [N s].
  void AddFloorImpulses(std::vector<Vec3>& impulses) const;

 private:
  struct Block;  // of a body
  void SetMasses(QuadraticProgram& problem) const;
  void SetVolumes(QuadraticProgram& problem) const;
  void SetStabilization(QuadraticProgram& problem) const;
  void SetGroups(QuadraticProgram& problem) const;
  void SetStiffness(QuadraticProgram& problem);
  double AddRow(const ContactRow& row, int number, std::vector<Eigen::Triplet<double>>& entries) const;
  void SetContacts(QuadraticProgram& problem);
  template <class Each>
  void ForContacts(std::size_t body, const Each& each) const;

  double dt_;
  ThreadTeam& team_;
  std::vector<std::unique_ptr<Block>> blocks_;
  std::vector<ContactRow> contacts_;
  int nodes_ = 0, rows_ = 0;  // of all bodies: free nodes, rows of volumes
  QpSolution solution_;
  int iterations_ = 0;
  double residual_ = 0;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_VELOCITY_PROGRAM_H_
