#include "core/voxel/solver.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

namespace fascicle {
namespace {

// Number of equal steps between two frames, none longer than the scene's time step.
std::int64_t StepsPerFrame(const Scene& scene) {
  const double interval = scene.output.frame_interval;
  if (scene.voxel.stepping == VoxelStepping::kStatic || !scene.voxel.time_step) return 1;
  // The tolerance prevents rounding from adding a step to a whole number of them.
  return std::max<std::int64_t>(1,
                                static_cast<std::int64_t>(std::ceil(interval / *scene.voxel.time_step * (1 - 1e-12))));
}

StepProblem ProblemOf(const EquilibriumResult& result) {
  return result.converged ? StepProblem::kNone : StepProblem::kNotSolved;
}

// The external actions on a body: forces [N] and prescribed displacements [m].
struct Acting {
  VoxelField<double> force, prescribed;
};
Acting ActingOn(const VoxelSceneBody& body, const BodyControls& controls) {
  const std::int32_t nodes = body.model().mesh().nodes();
  Acting acting = {VoxelField<double>(nodes), VoxelField<double>(nodes)};
  body.SetForces(controls, acting.force);
  body.Prescribe(controls, acting.prescribed);
  return acting;
}

std::string IndexName(const char* what, std::size_t body) { return what + std::to_string(body); }

}  // namespace

void VoxelSceneState::Save(ArchiveWriter& archive) const {
  archive.PutDouble("time", time);
  archive.PutInt("step", step);
  archive.PutDouble("time_step", time_step);
  archive.PutInt("iterations", iterations);
  archive.PutDoubles("elastic", elastic);
  archive.PutDoubles("kinetic", kinetic);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    bodies[b].Save(archive);
    std::vector<Vec3> forces, moments;
    for (const Reaction& reaction : reactions[b]) {
      forces.push_back(reaction.force);
      moments.push_back(reaction.moment);
    }
    archive.PutVectors(IndexName("reactions", b), forces);
    archive.PutVectors(IndexName("moments", b), moments);
  }
}

void VoxelSceneState::Load(ArchiveReader& archive) {
  time = archive.GetDouble("time");
  step = archive.GetInt("step");
  time_step = archive.GetDouble("time_step");
  iterations = archive.GetInt("iterations");
  archive.GetDoubles("elastic", std::span(elastic));
  archive.GetDoubles("kinetic", std::span(kinetic));
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    bodies[b].Load(archive);
    std::vector<Vec3> forces(reactions[b].size()), moments(reactions[b].size());
    archive.GetVectors(IndexName("reactions", b), std::span(forces));
    archive.GetVectors(IndexName("moments", b), std::span(moments));
    for (std::size_t k = 0; k < forces.size(); ++k) reactions[b][k] = {forces[k], moments[k]};
  }
}

VoxelSolver::VoxelSolver(const Scene& scene, ThreadTeam& team, Profile* profile)
    : scene_(scene), team_(team), profile_(profile), steps_per_frame_(StepsPerFrame(scene)) {
  const StageTimer timer(profile_, "levels");
  for (const Body& body : scene.bodies) {
    team.ThrowIfStopped();
    bodies_.push_back(std::make_unique<VoxelSceneBody>(scene, body));
    const VoxelSceneBody& made = *bodies_.back();
    static_solvers_.emplace_back();
    if (scene.voxel.stepping == VoxelStepping::kStatic) continue;
    DynamicSettings settings;
    settings.density = body.density;
    settings.mass_damping = body.damping.mass_proportional;
    settings.time_step = scene.output.frame_interval / static_cast<double>(steps_per_frame_);
    settings.tolerance = scene.voxel.tolerance;
    dynamic_solvers_.push_back(std::make_unique<VoxelDynamicSolver>(made.model(), made.supports(), settings, team_));
  }
}

VoxelStaticSolver& VoxelSolver::StaticSolverOf(std::size_t body) {
  if (static_solvers_[body] == nullptr) {
    const StageTimer timer(profile_, "levels");
    static_solvers_[body] =
        std::make_unique<VoxelStaticSolver>(bodies_[body]->model(), bodies_[body]->supports(), team_);
  }
  return *static_solvers_[body];
}

VoxelSceneState VoxelSolver::InitialState() const {
  VoxelSceneState state;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const std::int32_t nodes = bodies_[b]->model().mesh().nodes();
    VoxelState body;
    body.displacement = body.previous = VoxelField<double>(nodes);
    state.bodies.push_back(std::move(body));
    state.reactions.emplace_back(bodies_[b]->supports().size());
  }
  state.elastic.assign(bodies_.size(), 0.0);
  state.kinetic.assign(bodies_.size(), 0.0);
  return state;
}

VoxelSolveReport VoxelSolver::SolveStart(VoxelSceneState& state, const Controls& start) {
  if (scene_.voxel.stepping == VoxelStepping::kDynamic && !scene_.voxel.start_loaded) {
    // The motion of supports starts at their position at time 0.
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const BodyControls controls = ControlsOf(scene_, b, start);
      bodies_[b]->Prescribe(controls, state.bodies[b].displacement);
      bodies_[b]->Prescribe(controls, state.bodies[b].previous);
    }
    return {};
  }
  VoxelSolveReport report = SolveStatic(state, start);
  if (report.problem == StepProblem::kNone && scene_.voxel.stepping == VoxelStepping::kDynamic) {
    static_solvers_.clear();  // its levels are not needed any more
    static_solvers_.resize(bodies_.size());
  }
  return report;
}

VoxelSolveReport VoxelSolver::SolveStatic(VoxelSceneState& state, const Controls& next) {
  VoxelSceneState made = state;
  VoxelSolveReport total;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const VoxelSceneBody& body = *bodies_[b];
    const auto [force, prescribed] = ActingOn(body, ControlsOf(scene_, b, next));
    VoxelStaticSolver& solver = StaticSolverOf(b);
    const StageTimer timer(profile_, "static solve");
    StaticSolution solution =
        solver.Solve(force, prescribed, {.tolerance = scene_.voxel.tolerance}, &state.bodies[b].displacement);
    if (const StepProblem problem = ProblemOf(solution.iterations); problem != StepProblem::kNone) return {problem, b};
    total.residual = std::max(total.residual, solution.iterations.residual);
    made.reactions[b] = body.SumOverSupports(solution.reaction, solution.displacement);
    made.elastic[b] = solution.energy;
    made.iterations += solution.iterations.iterations;
    made.bodies[b].displacement = std::move(solution.displacement);
    made.bodies[b].previous = made.bodies[b].displacement;
  }
  state = std::move(made);
  return total;
}

VoxelSolveReport VoxelSolver::StepDynamic(VoxelSceneState& state, const Controls& next) {
  VoxelSceneState made = state;
  VoxelSolveReport total;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const VoxelSceneBody& body = *bodies_[b];
    const auto [force, prescribed] = ActingOn(body, ControlsOf(scene_, b, next));
    const StageTimer timer(profile_, "dynamic solve");
    const VoxelStepReport report = dynamic_solvers_[b]->Step(force, prescribed, made.bodies[b]);
    if (const StepProblem problem = ProblemOf(report.iterations); problem != StepProblem::kNone) return {problem, b};
    total.residual = std::max(total.residual, report.iterations.residual);
    made.elastic[b] = report.elastic;
    made.kinetic[b] = report.kinetic;
    made.iterations += report.iterations.iterations;
    made.reactions[b] = body.SumOverSupports(dynamic_solvers_[b]->Reaction(force, state.bodies[b], made.bodies[b]),
                                             made.bodies[b].displacement);
  }
  state = std::move(made);
  return total;
}

StepProposal VoxelSolver::ProposeStep(const VoxelSceneState& state, double end) const {
  if (scene_.voxel.stepping == VoxelStepping::kStatic) return {end, end - state.time, StepProblem::kNone, {}};
  const std::int64_t left = steps_per_frame_ - state.step % steps_per_frame_;
  const double dt = scene_.output.frame_interval / static_cast<double>(steps_per_frame_);
  return {left == 1 ? end : end - static_cast<double>(left - 1) * dt, dt, StepProblem::kNone, {}};
}

VoxelSolveReport VoxelSolver::Step(VoxelSceneState& state, const Controls& next, double dt) {
  const bool is_static = scene_.voxel.stepping == VoxelStepping::kStatic;
  const VoxelSolveReport report = is_static ? SolveStatic(state, next) : StepDynamic(state, next);
  if (report.problem != StepProblem::kNone) return report;
  state.time = next.time;
  state.time_step = dt;
  ++state.step;
  return report;
}

}  // namespace fascicle
