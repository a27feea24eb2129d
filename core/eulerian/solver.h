#ifndef FASCICLE_CORE_EULERIAN_SOLVER_H_
#define FASCICLE_CORE_EULERIAN_SOLVER_H_

#include "core/base/profile.h"
#include "core/base/step_problem.h"
#include "core/eulerian/forces.h"
#include "core/eulerian/momentum.h"
#include "core/eulerian/projection.h"

namespace fascicle {

struct EulerianReport {
  StepProblem problem = StepProblem::kNone;
  std::vector<std::int64_t> bad_cells;  // where, of the grid; at most 16
  double dt = 0;                        // of the step [s]
  double smallest_J = 1, largest_J = 1;
  int minres_iterations = 0;
};

// Steps a solid on its grid [Fan 2013, algorithm 1]: forces; velocities carried along; volume and what is held; the
// reference map carried along and continued into a band around the solid; the surface; plastic flow. One thread at a
// time; the same bits for any number of threads, and of a state that was saved and loaded.
class EulerianSolver {
 public:
  // Body and team must outlive it, and so must the profile, where stages are timed if there is one.
  EulerianSolver(const EulerianBody& body, ThreadTeam& team, Profile* profile = nullptr)
      : body_(&body), team_(&team), profile_(profile) {}

  // At time 0: X(x) = map(x), or x; v(x) = velocity(x), or 0.
  EulerianState InitialState(const std::function<Vec3(const Vec3&)>& map = nullptr,
                             const std::function<Vec3(const Vec3&)>& velocity = nullptr) const;

  // Makes one step, as long as is stable but not beyond `end` [s]. A step that fails leaves the state as it was.
  // Problems: kInvertedElement (the map folds), kLeftGrid, kVelocitiesNotFound (MINRES), kNotFinite, kStepTooSmall (a
  // millionth of what waves take through a cell at rest).
  EulerianReport Step(double end, EulerianState& state);

  // Of the state before the last step.
  const EulerianCells& cells() const { return cells_; }
  const NodalForces& nodes() const { return nodes_; }
  // Of each support, its force on the body in the mean of the last step [N].
  const std::vector<Vec3>& reactions() const { return reactions_; }

 private:
  StepProblem Prepare(const EulerianState& state, EulerianReport& report);
  Resultant Conserve(const EulerianState& state, std::vector<Vec3>& v) const;
  StepLength StableStep(const EulerianState& state) const;
  std::vector<std::int64_t> CellsAtSide() const;
  StepProblem Accelerate(const EulerianState& state, const StepLength& step, EulerianReport& report);
  bool AllFinite(const std::vector<Vec3>& v) const;
  void Carry(const std::vector<Vec3>& field, const std::vector<Vec3>& v, const EulerianState& state, double dt,
             std::vector<Vec3>& result);
  StepProblem Move(const EulerianState& state, double dt);

  const EulerianBody* body_;
  ThreadTeam* team_;
  Profile* profile_;
  EulerianCells cells_;  // scratch
  NodalForces nodes_;
  std::vector<Vec3> reactions_;
  std::vector<Vec3> now_;  // velocities at the start of the step, with the momentum that they should have
  EulerianState next_;     // that is being made: its memory is used again in the next step
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_SOLVER_H_
