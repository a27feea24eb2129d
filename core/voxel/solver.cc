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

StepProblem ProblemOf(const EquilibriumResult& result, const std::stop_token& stop) {
  if (result.converged) return StepProblem::kNone;
  return stop.stop_requested() ? StepProblem::kStopped : StepProblem::kNotSolved;
}

// The external actions on a body at a time: forces [N] and prescribed displacements [m].
struct Acting {
  VoxelField<double> force, prescribed;
};
Acting ActingAt(const VoxelSceneBody& body, double time) {
  const std::int32_t nodes = body.model().mesh().nodes();
  Acting acting = {VoxelField<double>(nodes), VoxelField<double>(nodes)};
  body.ForceAt(time, acting.force);
  body.PrescribeAt(time, acting.prescribed);
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
    archive.PutVectors(IndexName("reactions", b), reactions[b]);
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
    archive.GetVectors(IndexName("reactions", b), std::span(reactions[b]));
  }
}

VoxelSolver::VoxelSolver(const Scene& scene, ThreadTeam& team, Profile* profile)
    : scene_(scene), team_(team), profile_(profile), steps_per_frame_(StepsPerFrame(scene)) {
  const StageTimer timer(profile_, "levels");
  for (const Body& body : scene.bodies) {
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
    state.reactions.emplace_back(bodies_[b]->supports().size(), Vec3::Zero());
  }
  state.elastic.assign(bodies_.size(), 0.0);
  state.kinetic.assign(bodies_.size(), 0.0);
  return state;
}

VoxelSolveReport VoxelSolver::SolveStart(VoxelSceneState& state, std::stop_token stop) {
  if (scene_.voxel.stepping == VoxelStepping::kDynamic && !scene_.voxel.start_loaded) {
    // The motion of supports starts at their position at time 0.
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      bodies_[b]->PrescribeAt(0, state.bodies[b].displacement);
      bodies_[b]->PrescribeAt(0, state.bodies[b].previous);
    }
    return {};
  }
  VoxelSolveReport report = SolveStatic(state, 0, stop);
  if (report.problem == StepProblem::kNone && scene_.voxel.stepping == VoxelStepping::kDynamic) {
    static_solvers_.clear();  // its levels are not needed any more
    static_solvers_.resize(bodies_.size());
  }
  return report;
}

VoxelSolveReport VoxelSolver::SolveStatic(VoxelSceneState& state, double time, const std::stop_token& stop) {
  VoxelSceneState next = state;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const VoxelSceneBody& body = *bodies_[b];
    const auto [force, prescribed] = ActingAt(body, time);
    VoxelStaticSolver& solver = StaticSolverOf(b);
    const StageTimer timer(profile_, "static solve");
    StaticSolution solution = solver.Solve(force, prescribed, {.tolerance = scene_.voxel.tolerance, .stop = stop},
                                           &state.bodies[b].displacement);
    if (const StepProblem problem = ProblemOf(solution.iterations, stop); problem != StepProblem::kNone) {
      return {problem, b};
    }
    next.reactions[b] = body.SumOverSupports(solution.reaction);
    next.elastic[b] = solution.energy;
    next.iterations += solution.iterations.iterations;
    next.bodies[b].displacement = std::move(solution.displacement);
    next.bodies[b].previous = next.bodies[b].displacement;
  }
  state = std::move(next);
  return {};
}

VoxelSolveReport VoxelSolver::StepDynamic(VoxelSceneState& state, double time, const std::stop_token& stop) {
  VoxelSceneState next = state;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const VoxelSceneBody& body = *bodies_[b];
    const auto [force, prescribed] = ActingAt(body, time);
    const StageTimer timer(profile_, "dynamic solve");
    const VoxelStepReport report = dynamic_solvers_[b]->Step(force, prescribed, next.bodies[b], stop);
    if (const StepProblem problem = ProblemOf(report.iterations, stop); problem != StepProblem::kNone) {
      return {problem, b};
    }
    next.elastic[b] = report.elastic;
    next.kinetic[b] = report.kinetic;
    next.iterations += report.iterations.iterations;
    next.reactions[b] = body.SumOverSupports(dynamic_solvers_[b]->Reaction(force, state.bodies[b], next.bodies[b]));
  }
  state = std::move(next);
  return {};
}

VoxelSolveReport VoxelSolver::Advance(VoxelSceneState& state, double end, std::stop_token stop) {
  const bool is_static = scene_.voxel.stepping == VoxelStepping::kStatic;
  const std::int64_t left = steps_per_frame_ - state.step % steps_per_frame_;
  const double dt = is_static ? end - state.time : scene_.output.frame_interval / static_cast<double>(steps_per_frame_);
  const double time = left == 1 ? end : end - static_cast<double>(left - 1) * dt;
  const VoxelSolveReport report = is_static ? SolveStatic(state, time, stop) : StepDynamic(state, time, stop);
  if (report.problem != StepProblem::kNone) return report;
  state.time = time;
  state.time_step = dt;
  ++state.step;
  return report;
}

}  // namespace fascicle
