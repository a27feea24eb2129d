#ifndef FASCICLE_CORE_EULERIAN_BODY_STEPPER_H_
#define FASCICLE_CORE_EULERIAN_BODY_STEPPER_H_

#include <functional>

#include "core/base/profile.h"
#include "core/base/step_problem.h"
#include "core/eulerian/momentum.h"
#include "core/eulerian/velocity_program.h"

namespace fascicle {

// The longest step of a body [s].
struct StepLength {
  double waves = 0;   // that the fastest wave allows
  double stable = 0;  // that is stable: also for travel, damping, and the scene's own limit
};

// The stages of a step of one body on its grid [Fan 2013, algorithm 1], with their scratch; EulerianWorld calls them in
// the order in which they are declared. The state is never changed: what is made is `made`. Not thread-safe.
class BodyStepper {
 public:
  // Body and team must outlive it, and so must the profile, where stages are timed if there is one.
  BodyStepper(const EulerianBody& body, ThreadTeam& team, Profile* profile)
      : body_(&body), team_(&team), profile_(profile) {}

  // X(x) = map(x), or x; v(x) = velocity(x), or 0.
  EulerianState InitialState(const std::function<Vec3(const Vec3&)>& map = nullptr,
                             const std::function<Vec3(const Vec3&)>& velocity = nullptr) const;

  // Cells, roles of nodes, masses and forces. Problems: kInvertedElement (the map folds), kLeftGrid; `bad_cells` says
  // where, at most 16.
  StepProblem Prepare(const EulerianState& state, const BodyControls& now, std::vector<std::int64_t>& bad_cells);
  StepLength FindStepLength(const EulerianState& state, const BodyControls& now);
  // A millionth of what waves take through a cell at rest [s]: nothing gets on by less.
  double LeastStep() const;

  // Advects velocities by themselves, after giving the body its momentum back.
  void AdvectVelocities(const EulerianState& state, double dt);
  // Adds what forces do to free nodes; prescribed ones get the velocity that takes them where their supports go.
  void Accelerate(const EulerianState& state, const BodyControls& now, const BodyControls& next, double dt);
  // What the program of all bodies has to know; null is left out where neither volumes nor elasticity ask for it.
  bool needs_program() const { return body_->volume != VolumeTreatment::kNone || body_->implicit_elasticity; }
  VelocityProgram::Part PartOf(const EulerianState& state, const BodyControls& now) const;
  void TakeVelocities(const VelocityProgram& program, std::size_t body);
  // Reactions of supports, and the velocities of constrained nodes. Problems: kNotFinite.
  StepProblem FinishVelocities(double dt);
  // The map, the surface and what is plastic, by the new velocities. Problems: kInvertedElement.
  StepProblem Move(const EulerianState& state, const BodyControls& next, double dt);

  // Made of the state that the stages were called with.
  EulerianState& made() { return made_; }

  // Of the last state that was prepared.
  const EulerianCells& cells() const { return cells_; }
  const NodeRoles& roles() const { return roles_; }
  const NodalForces& forces() const { return forces_; }

 private:
  std::vector<std::int64_t> CellsAtSide() const;
  Resultant Conserve(const EulerianState& state, std::vector<Vec3>& v) const;
  bool AllFinite(const std::vector<Vec3>& v) const;
  void AdvectField(const std::vector<Vec3>& field, const std::vector<Vec3>& v, const EulerianState& state, double dt,
                   std::vector<Vec3>& result);
  void AdvectPoints(const EulerianState& state, double dt, std::vector<Vec3>& points);

  const EulerianBody* body_;
  ThreadTeam* team_;
  Profile* profile_;
  EulerianCells cells_;
  NodeRoles roles_;
  NodalForces forces_;
  double waves_ = 0;            // StepLength::waves
  std::vector<Vec3> now_;       // velocities at the start of the step, with the momentum that they should have
  std::vector<Vec3> impulses_;  // of supports on prescribed nodes [N s]; empty without supports
  EulerianState made_;          // its memory is used again in the next step
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_BODY_STEPPER_H_
