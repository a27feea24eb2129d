#include "core/sim/eulerian_run.h"

#include <algorithm>
#include <utility>

#include "core/eulerian/scene_body.h"
#include "core/sim/eulerian_measure.h"

namespace fascicle {
namespace {

// Bodies don't touch, so each steps by itself: the one that is behind all others first.
class EulerianRun : public MethodRun {
 public:
  EulerianRun(const Scene& scene, ThreadTeam& team, Profile* profile) : scene_(scene), team_(team) {
    for (const Body& body : scene.bodies) {
      bodies_.push_back(std::make_unique<EulerianBody>(MakeEulerianBody(scene, body, team)));
      solvers_.emplace_back(*bodies_.back(), team, profile);
    }
  }

  std::vector<SeriesInfo> Series() const override { return EulerianSeriesOf(scene_); }

  void Start() override {
    states_.clear();
    for (const EulerianSolver& solver : solvers_) states_.push_back(solver.InitialState());
    iterations_ = 0;
    time_step_ = 0;
  }
  StepOutcome SolveStart(std::stop_token) override { return {}; }
  RunClock clock() const override {
    RunClock clock{states_[Last()].time, 0, time_step_, iterations_};
    for (const EulerianState& state : states_) clock.step += state.step;
    return clock;
  }
  StepOutcome Advance(double end, std::stop_token) override {
    const std::size_t b = Last();
    const EulerianReport report = solvers_[b].Step(end, states_[b]);
    if (report.problem != StepProblem::kNone) {
      return {report.problem, {b, report.bad_cells, report.problem == StepProblem::kInvertedElement}};
    }
    iterations_ += report.minres_iterations;
    time_step_ = report.dt;
    return {};
  }

  double LargestSpeed() const override {
    double largest = 0;
    for (std::size_t b = 0; b < states_.size(); ++b) {
      const EulerianState& state = states_[b];
      for (std::size_t n = 0; n < state.v.size(); ++n) {
        if (state.known[n] == 0 || bodies_[b]->shape.Distance(state.X[n]) > 0) continue;
        largest = std::max(largest, state.v[n].norm());
      }
    }
    return largest;
  }

  std::vector<BodyFrame> MeasureBodies() const override {
    std::vector<BodyFrame> frames;
    for (std::size_t b = 0; b < states_.size(); ++b) {
      frames.push_back(MeasureEulerianBody(scene_, *bodies_[b], states_[b], team_));
    }
    return frames;
  }
  std::vector<double> MeasureSeries(std::int64_t iterations_before) const override {
    return MeasureEulerianSeries(scene_, bodies_, states_, solvers_, time_step_, iterations_ - iterations_before,
                                 team_);
  }

  void Save(ArchiveWriter& archive) const override {
    archive.PutInt("iterations", iterations_);
    archive.PutDouble("time_step", time_step_);
    for (const EulerianState& state : states_) state.Save(archive);
  }
  void Load(ArchiveReader& archive) override {
    iterations_ = archive.GetInt("iterations");
    time_step_ = archive.GetDouble("time_step");
    for (EulerianState& state : states_) state.Load(archive);
  }

 private:
  // The body that is behind all others.
  std::size_t Last() const {
    std::size_t last = 0;
    for (std::size_t b = 1; b < states_.size(); ++b) {
      if (states_[b].time < states_[last].time) last = b;
    }
    return last;
  }

  const Scene& scene_;
  ThreadTeam& team_;
  std::vector<std::unique_ptr<EulerianBody>> bodies_;
  std::vector<EulerianSolver> solvers_;
  std::vector<EulerianState> states_;
  std::int64_t iterations_ = 0;
  double time_step_ = 0;
};

}  // namespace

std::unique_ptr<MethodRun> MakeEulerianRun(const Scene& scene, ThreadTeam& team, Profile* profile) {
  return std::make_unique<EulerianRun>(scene, team, profile);
}

}  // namespace fascicle
