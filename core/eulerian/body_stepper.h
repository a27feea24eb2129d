#ifndef FASCICLE_CORE_EULERIAN_BODY_STEPPER_H_
#define FASCICLE_CORE_EULERIAN_BODY_STEPPER_H_

#include <functional>

#include "core/base/profile.h"
#include "core/base/step_problem.h"
#include "core/eulerian/momentum.h"
#include "core/eulerian/velocity_program.h"

namespace fascicle {

// Upper bounds of a body's step [s].
struct StepLength {
  double waves = 0;   // the bound due to the fastest wave
  double stable = 0;  // the bound due to waves, travel, damping, and the scene's own limit
};

// The stages of a step of one body on its grid [Fan 2013, algorithm 1] and their scratch memory. EulerianWorld calls
// them in the order of their declaration. The given state is not changed; results are in `made`. Not thread-safe.
class BodyStepper {
 public:
  // Body and team must outlive this, as must the profile, which may be null.
  BodyStepper(const EulerianBody& body, ThreadTeam& team, Profile* profile)
      : body_(&body), team_(&team), profile_(profile) {}

  // X(x) = map(x), or x; v(x) = velocity(x), or 0.
  EulerianState InitialState(const std::function<Vec3(const Vec3&)>& map = nullptr,
                             const std::function<Vec3(const Vec3&)>& velocity = nullptr) const;

  // Sets cells, roles of nodes, masses and forces. Problems: kInvertedElement (the map folds), kLeftGrid; `bad_cells`
  // are at most 16 cells where that is.
  StepProblem Prepare(const EulerianState& state, const BodyControls& now, std::vector<std::int64_t>& bad_cells);
  StepLength FindStepLength(const EulerianState& state, const BodyControls& now);
  double waves() const { return waves_; }  // StepLength::waves of the last FindStepLength [s]
  // The largest speed of a node with mass beside a rigid velocity [m/s]. Both in the grid's frame.
  double FastestBeside(const std::vector<Vec3>& v, const RigidVelocity& rigid) const;
  // The shortest useful step: a millionth of the time that waves need to cross a cell at rest [s].
  double LeastStep() const;

  // Restores the body's momentum, then advects velocities by themselves.
  void AdvectVelocities(const EulerianState& state, double dt);
  // Adds the effect of forces to free nodes, and sets the velocities of prescribed nodes to those of their supports.
  void Accelerate(const EulerianState& state, const BodyControls& now, const BodyControls& next, double dt);
  // The body's part of the velocity program, which is needed only for volume preservation and implicit elasticity.
  bool needs_program() const { return body_->volume != VolumeTreatment::kNone || body_->implicit_elasticity; }
  VelocityProgram::Part PartOf(const EulerianState& state, const BodyControls& now) const;
  void TakeVelocities(const VelocityProgram& program, std::size_t body);
  // Sets reactions of supports and velocities of constrained nodes. Problems: kNotFinite.
  StepProblem FinishVelocities(double dt);
  // Advects the map, moves the surface and updates plasticity. Problems: kInvertedElement.
  StepProblem Move(const EulerianState& state, const BodyControls& next, double dt);

  // The result for the state of the last calls.
  EulerianState& made() { return made_; }

  // The cells of the state of the last Prepare.
  const EulerianCells& cells() const { return cells_; }
  const NodeRoles& roles() const { return roles_; }
  const NodalForces& forces() const { return forces_; }

 private:
  std::vector<std::int64_t> CellsAtSide() const;
  Resultant Conserve(const EulerianState& state, std::vector<Vec3>& v) const;
  bool AllFinite(const std::vector<Vec3>& v) const;
  void AdvectField(const std::vector<Vec3>& field, const std::vector<Vec3>& v, const EulerianState& state, double dt,
                   std::vector<Vec3>& result);
  void AdvectPoints(const std::vector<Vec3>& velocity, const EulerianState& state, double dt,
                    std::vector<Vec3>& points);
  std::vector<Vec3> ThroughGrid(const std::vector<Vec3>& v, const RigidVelocity& rigid) const;
  void Travel(const RigidVelocity& rigid, double dt);

  const EulerianBody* body_;
  ThreadTeam* team_;
  Profile* profile_;
  EulerianCells cells_;
  NodeRoles roles_;
  NodalForces forces_;
  GridFrame frame_;             // of the state of the last Prepare
  RigidVelocity rigid_;         // the velocity of the grid in that state; zero if it does not travel
  double waves_ = 0;            // StepLength::waves
  std::vector<Vec3> now_;       // velocities at the start of the step, with the momentum restored
  std::vector<Vec3> impulses_;  // of supports on prescribed nodes [N s]; empty without supports
  EulerianState made_;          // its memory is reused in the next step
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_BODY_STEPPER_H_
