#ifndef FASCICLE_TESTS_SUPPORT_TET_STEPPER_H_
#define FASCICLE_TESTS_SUPPORT_TET_STEPPER_H_

#include <utility>
#include <vector>

#include "core/sim/control_source.h"
#include "core/tet/diagnostics.h"
#include "core/tet/solver.h"

namespace fascicle::testing {

// A solver with the controls of its scene's curves, stepped as Simulation does.
class TetStepper {
 public:
  TetStepper(const TetModel& model, ThreadTeam& team, Profile* profile = nullptr)
      : model_(&model), team_(&team), source_(model.scene()), solver_(model, team, profile) {}

  TetState InitialState() {
    source_.Evaluate(0, now_);
    return solver_.InitialState(now_);
  }

  // Makes one step towards `end` [s]: the proposed one, or a shorter one if that fails.
  StepReport Advance(TetState& state, double end) {
    source_.Evaluate(state.time, now_);
    for (;;) {
      StepProposal step = solver_.ProposeStep(state, now_, end);
      if (step.problem != StepProblem::kNone) {
        StepReport report;
        report.problem = step.problem;
        report.bad = std::move(step.bad);
        return report;
      }
      source_.Evaluate(step.time, next_);
      StepReport report = solver_.Step(state, now_, next_, step.dt);
      if (!report.try_shorter) return report;
    }
  }

  // One attempt to step from `now` to `time` [s].
  StepReport Attempt(const TetState& now, double time, TetState& made) {
    source_.Evaluate(now.time, now_);
    source_.Evaluate(time, next_);
    return solver_.Attempt(now, now_, next_, time - now.time, made);
  }

  double StableStepAt(const TetState& state) { return solver_.StableStepAt(state, source_.At(state.time)); }
  std::vector<Vec3> Reactions(const TetState& state) {
    std::vector<Vec3> forces;
    for (const Reaction& reaction : ReactionsWithMoments(state)) forces.push_back(reaction.force);
    return forces;
  }
  std::vector<Reaction> ReactionsWithMoments(const TetState& state) {
    return fascicle::Reactions(*model_, state, source_.At(state.time), source_.At(state.time + state.time_step),
                               *team_);
  }
  double EquilibriumResidual(const TetState& state) {
    return fascicle::EquilibriumResidual(*model_, state, source_.At(state.time), *team_);
  }

 private:
  const TetModel* model_;
  ThreadTeam* team_;
  ControlSource source_;
  TetSolver solver_;
  Controls now_, next_;
};

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_TET_STEPPER_H_
