#include "core/sim/eulerian_run.h"

#include <algorithm>
#include <utility>

#include "core/eulerian/scene_body.h"
#include "core/sim/eulerian_measure.h"

namespace fascicle {
namespace {

using Bodies = std::vector<std::unique_ptr<const EulerianBody>>;

Bodies MakeBodies(const Scene& scene, ThreadTeam& team) {
  Bodies bodies;
  for (const Body& body : scene.bodies) {
    bodies.push_back(std::make_unique<const EulerianBody>(MakeEulerianBody(scene, body, team)));
  }
  return bodies;
}

std::vector<const EulerianBody*> PointersTo(const Bodies& bodies) {
  std::vector<const EulerianBody*> pointers;
  for (const auto& body : bodies) pointers.push_back(body.get());
  return pointers;
}

class EulerianRun : public MethodRun {
 public:
  EulerianRun(const Scene& scene, ThreadTeam& team, Profile* profile)
      : scene_(scene),
        team_(team),
        bodies_(MakeBodies(scene, team)),
        world_(scene, PointersTo(bodies_), team, profile) {}

  std::vector<SeriesInfo> Series() const override { return EulerianSeriesOf(scene_); }
  std::vector<SeriesInfo> LaterSeries() const override { return EulerianLaterSeriesOf(scene_); }

  void Start(const Controls&) override { state_ = world_.InitialState(); }
  StepOutcome SolveStart(const Controls&) override { return {}; }
  RunClock clock() const override { return {state_.time, state_.step, state_.time_step, state_.iterations}; }
  StepProposal ProposeStep(const Controls& now, double end) override { return world_.ProposeStep(state_, now, end); }
  StepOutcome Step(const Controls& now, const Controls& next, double dt) override {
    EulerianReport report = world_.Step(state_, now, next, dt);
    StepOutcome outcome = {report.problem, std::move(report.bad)};
    outcome.residual = report.residual;
    return outcome;
  }

  double LargestSpeed() const override {
    double largest = 0;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const EulerianState& state = state_.bodies[b];
      for (std::size_t n = 0; n < state.v.size(); ++n) {
        if (state.known[n] == 0 || bodies_[b]->shape.Distance(state.X[n]) > 0) continue;
        largest = std::max(largest, state.v[n].norm());
      }
    }
    return largest;
  }

  std::vector<BodyFrame> MeasureBodies(const Controls& now, const Controls&) const override {
    std::vector<BodyFrame> frames;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      frames.push_back(MeasureEulerianBody(scene_, *bodies_[b], state_.bodies[b], ControlsOf(scene_, b, now), team_));
    }
    return frames;
  }
  std::vector<double> ElementValues(std::size_t, OutputField, const Controls&, const Controls&) const override {
    return {};
  }
  std::vector<Reaction> Reactions(const Controls&, const Controls&) const override {
    std::vector<Reaction> reactions;
    for (const EulerianState& body : state_.bodies) {
      for (std::size_t s = 0; s < body.reactions.size(); ++s) reactions.push_back({body.reactions[s], body.moments[s]});
    }
    return reactions;
  }
  std::vector<double> MeasureSeries(const Controls& now, const std::vector<Reaction>& reactions,
                                    std::int64_t iterations_before) const override {
    return MeasureEulerianSeries(scene_, PointersTo(bodies_), state_, now, reactions, iterations_before, team_);
  }
  std::vector<double> MeasureLaterSeries(const Controls& now, const std::vector<Reaction>& reactions) const override {
    return MeasureEulerianLaterSeries(scene_, PointersTo(bodies_), state_, now, reactions, team_);
  }

  void Save(ArchiveWriter& archive) const override { state_.Save(archive); }
  void Load(ArchiveReader& archive) override { state_.Load(archive); }

 private:
  const Scene& scene_;
  ThreadTeam& team_;
  const Bodies bodies_;
  EulerianWorld world_;
  EulerianWorldState state_;
};

}  // namespace

std::unique_ptr<MethodRun> MakeEulerianRun(const Scene& scene, ThreadTeam& team, Profile* profile) {
  return std::make_unique<EulerianRun>(scene, team, profile);
}

}  // namespace fascicle
