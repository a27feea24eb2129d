#include "core/eulerian/world.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace fascicle {

EulerianWorld::EulerianWorld(const Scene& scene, const std::vector<const EulerianBody*>& bodies, ThreadTeam& team,
                             Profile* profile)
    : scene_(scene), team_(team), profile_(profile) {
  for (const EulerianBody* body : bodies) steppers_.emplace_back(*body, team, profile);
}

EulerianWorldState EulerianWorld::InitialState() const {
  EulerianWorldState state;
  for (const BodyStepper& stepper : steppers_) state.bodies.push_back(stepper.InitialState());
  return state;
}

std::vector<BodyControls> EulerianWorld::ControlsOfBodies(const Controls& controls) const {
  std::vector<BodyControls> bodies;
  for (std::size_t b = 0; b < steppers_.size(); ++b) bodies.push_back(ControlsOf(scene_, b, controls));
  return bodies;
}

StepProposal EulerianWorld::ProposeStep(const EulerianWorldState& state, const Controls& controls, double end) {
  const std::vector<BodyControls> now = ControlsOfBodies(controls);
  StepProposal proposal;
  double stable = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < steppers_.size(); ++b) {
    proposal.problem = steppers_[b].Prepare(state.bodies[b], now[b], proposal.bad.elements);
    proposal.bad.body = b;
    proposal.bad.inverted = proposal.problem == StepProblem::kInvertedElement;
    if (proposal.problem != StepProblem::kNone) return proposal;
    const double of_body = steppers_[b].FindStepLength(state.bodies[b], now[b]).stable;
    if (!(of_body >= steppers_[b].LeastStep())) {
      proposal.problem = StepProblem::kStepTooSmall;
      return proposal;
    }
    stable = std::min(stable, of_body);
  }
  // The last two steps before a frame have equal length: a very short one would disturb the pressure.
  const double left = end - state.time;
  proposal.dt = left <= stable ? left : std::min(stable, left / 2);
  proposal.time = left <= stable ? end : state.time + proposal.dt;
  return proposal;
}

EulerianReport EulerianWorld::Step(EulerianWorldState& state, const Controls& controls_now,
                                   const Controls& controls_next, double dt) {
  const std::vector<BodyControls> now = ControlsOfBodies(controls_now), next = ControlsOfBodies(controls_next);
  EulerianReport report;
  const auto fails = [&](StepProblem problem, std::size_t body) {
    report = {problem, {body, {}, problem == StepProblem::kInvertedElement}};
    return problem != StepProblem::kNone;
  };
  for (std::size_t b = 0; b < steppers_.size(); ++b) steppers_[b].AdvectVelocities(state.bodies[b], dt);
  int iterations = 0;
  double residual = -1;
  {
    const StageTimer timer(profile_, "constraints");
    for (std::size_t b = 0; b < steppers_.size(); ++b) {
      steppers_[b].Accelerate(state.bodies[b], now[b], next[b], dt);
    }
    if (fails(FindVelocities(state, now, dt, iterations, residual), 0)) return report;
    for (std::size_t b = 0; b < steppers_.size(); ++b) {
      if (fails(steppers_[b].FinishVelocities(dt), b)) return report;
    }
  }
  for (std::size_t b = 0; b < steppers_.size(); ++b) {
    if (fails(steppers_[b].Move(state.bodies[b], next[b], dt), b)) return report;
  }
  for (std::size_t b = 0; b < steppers_.size(); ++b) std::swap(state.bodies[b], steppers_[b].made());
  state.time = controls_next.time;
  state.time_step = dt;
  state.iterations += iterations;
  ++state.step;
  report.residual = residual;
  return report;
}

// Solves for volumes, supports and implicit elasticity of all bodies together.
StepProblem EulerianWorld::FindVelocities(const EulerianWorldState& state, const std::vector<BodyControls>& now,
                                          double dt, int& iterations, double& residual) {
  VelocityProgram program(dt, team_);
  std::vector<std::size_t> added;
  for (std::size_t b = 0; b < steppers_.size(); ++b) {
    if (!steppers_[b].needs_program()) continue;
    program.AddBody(steppers_[b].PartOf(state.bodies[b], now[b]));
    added.push_back(b);
  }
  if (added.empty()) return StepProblem::kNone;
  if (program.Solve() != QpStatus::kSolved) return StepProblem::kVelocitiesNotFound;
  iterations = program.iterations();
  residual = program.residual();
  for (std::size_t k = 0; k < added.size(); ++k) steppers_[added[k]].TakeVelocities(program, k);
  return StepProblem::kNone;
}

}  // namespace fascicle
