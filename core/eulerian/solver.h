#ifndef FASCICLE_CORE_EULERIAN_SOLVER_H_
#define FASCICLE_CORE_EULERIAN_SOLVER_H_

#include "core/base/step_problem.h"
#include "core/eulerian/forces.h"
#include "core/eulerian/projection.h"

namespace fascicle {

struct EulerianReport {
  StepProblem problem = StepProblem::kNone;
  bool left_grid = false;  // the solid has come to the side of its grid
  double dt = 0;           // of the step [s]
  double smallest_J = 1, largest_J = 1;
  int minres_iterations = 0;
};

// Steps a solid on its grid [Fan 2013, algorithm 1]: forces, explicit; velocities carried along; volume and what is
// held; the reference map carried along and continued into a band around the solid. One thread at a time; the same bits
// for any number of threads, and of a state that was saved and loaded.
class EulerianSolver {
 public:
  // Body and team must outlive it.
  EulerianSolver(const EulerianBody& body, ThreadTeam& team) : body_(&body), team_(&team) {}

  // At rest at time 0: X(x) = map(x), or x; v(x) = velocity(x), or 0.
  EulerianState InitialState(const std::function<Vec3(const Vec3&)>& map = nullptr,
                             const std::function<Vec3(const Vec3&)>& velocity = nullptr) const;

  // Makes one step, as long as is stable but not beyond `end` [s]. A step that fails leaves the state as it was.
  EulerianReport Step(double end, EulerianState& state);

  // Of the state that was stepped last.
  const EulerianCells& cells() const { return cells_; }
  const NodalForces& nodes() const { return nodes_; }

 private:
  double StableStep(const EulerianState& state) const;
  bool IsAtSide() const;

  const EulerianBody* body_;
  ThreadTeam* team_;
  EulerianCells cells_;  // scratch
  NodalForces nodes_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_SOLVER_H_
