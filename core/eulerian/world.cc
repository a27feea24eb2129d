#include "core/eulerian/world.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace fascicle {
namespace {

constexpr std::size_t kNoGroup = std::numeric_limits<std::size_t>::max();

// For each body, the first body of its group: rows of contact couple the bodies of a group. kNoGroup without contact.
std::vector<std::size_t> GroupsOf(std::size_t bodies, const std::vector<ContactRow>& rows) {
  std::vector<std::size_t> group_of(bodies, kNoGroup);
  for (const ContactRow& row : rows) {
    const std::size_t a = row.parts.front().body, b = row.parts.back().body;
    const std::size_t group = std::min({a, b, group_of[a], group_of[b]});
    const std::size_t old_a = group_of[a], old_b = group_of[b];
    for (std::size_t& of_body : group_of) {
      if (of_body != kNoGroup && (of_body == old_a || of_body == old_b)) of_body = group;
    }
    group_of[a] = group_of[b] = group;
  }
  return group_of;
}

}  // namespace

EulerianWorld::EulerianWorld(const Scene& scene, const std::vector<const EulerianBody*>& bodies, ThreadTeam& team,
                             Profile* profile)
    : scene_(scene), team_(team), profile_(profile), contacts_(scene, bodies, team) {
  for (const EulerianBody* body : bodies) steppers_.emplace_back(*body, team, profile);
}

EulerianWorldState EulerianWorld::InitialState() const {
  EulerianWorldState state;
  for (const BodyStepper& stepper : steppers_) state.bodies.push_back(stepper.InitialState());
  state.floor_forces.assign(scene_.floors.size(), Vec3::Zero());
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
  if (!contacts_.empty()) {
    const StageTimer timer(profile_, "detection of contacts");
    contacts_.Find(state, steppers_);
    stable = std::min(stable, contacts_.LongestStep());
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
  floor_impulses_.assign(scene_.floors.size(), Vec3::Zero());
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
  for (std::size_t f = 0; f < floor_impulses_.size(); ++f) state.floor_forces[f] = floor_impulses_[f] / dt;
  state.time = controls_next.time;
  state.time_step = dt;
  state.iterations += iterations;
  ++state.step;
  report.residual = residual;
  return report;
}

// Solves for volumes, supports, contacts and implicit elasticity: of all bodies without contacts together, and of each
// group of bodies that touch.
StepProblem EulerianWorld::FindVelocities(const EulerianWorldState& state, const std::vector<BodyControls>& now,
                                          double dt, int& iterations, double& residual) {
  const std::vector<ContactRow> rows = contacts_.empty() ? std::vector<ContactRow>() : ContactRowsFor(dt);
  const std::vector<std::size_t> group_of = GroupsOf(steppers_.size(), rows);
  std::vector<std::size_t> alone;
  std::map<std::size_t, std::vector<std::size_t>> groups;
  for (std::size_t b = 0; b < steppers_.size(); ++b) {
    if (group_of[b] != kNoGroup) {
      groups[group_of[b]].push_back(b);
    } else if (steppers_[b].needs_program()) {
      alone.push_back(b);
    }
  }
  StepProblem problem = StepProblem::kNone;
  if (!alone.empty()) problem = SolveProgram(alone, {}, state, now, dt, iterations, residual);
  for (const auto& [first, bodies] : groups) {
    if (problem == StepProblem::kNone) problem = SolveProgram(bodies, rows, state, now, dt, iterations, residual);
  }
  return problem;
}

std::vector<ContactRow> EulerianWorld::ContactRowsFor(double dt) {
  std::vector<const std::vector<Vec3>*> velocities;
  std::vector<double> waves;
  for (BodyStepper& stepper : steppers_) {
    velocities.push_back(&stepper.made().v);
    waves.push_back(stepper.waves());
  }
  return contacts_.Rows(dt, velocities, waves);
}

// The program of some bodies, with those of the rows that are between them. Adds to the iterations.
StepProblem EulerianWorld::SolveProgram(const std::vector<std::size_t>& bodies, const std::vector<ContactRow>& rows,
                                        const EulerianWorldState& state, const std::vector<BodyControls>& now,
                                        double dt, int& iterations, double& residual) {
  VelocityProgram program(dt, team_);
  std::map<std::size_t, std::size_t> number;
  for (const std::size_t b : bodies) {
    number[b] = number.size();
    program.AddBody(steppers_[b].PartOf(state.bodies[b], now[b]));
  }
  for (ContactRow row : rows) {
    if (!number.contains(row.parts[0].body)) continue;
    for (ContactPart& part : row.parts) part.body = number.at(part.body);
    program.AddContact(std::move(row));
  }
  if (program.Solve() != QpStatus::kSolved) return StepProblem::kVelocitiesNotFound;
  iterations += program.iterations();
  residual = std::max(residual, program.residual());
  program.AddFloorImpulses(floor_impulses_);
  for (std::size_t k = 0; k < bodies.size(); ++k) steppers_[bodies[k]].TakeVelocities(program, k);
  return StepProblem::kNone;
}

}  // namespace fascicle
