#include "core/sim/voxel_run.h"

#include <algorithm>
#include <utility>

#include "core/sim/voxel_measure.h"
#include "core/voxel/solver.h"

namespace fascicle {
namespace {

class VoxelMethodRun : public MethodRun {
 public:
  VoxelMethodRun(const Scene& scene, ThreadTeam& team, Profile* profile)
      : scene_(scene), solver_(scene, team, profile) {}

  std::vector<SeriesInfo> Series() const override { return VoxelSeriesOf(scene_); }
  std::vector<SeriesInfo> LaterSeries() const override { return VoxelLaterSeriesOf(scene_); }

  void Start(const Controls&) override { state_ = solver_.InitialState(); }
  StepOutcome SolveStart(const Controls& start) override { return OutcomeOf(solver_.SolveStart(state_, start)); }
  RunClock clock() const override { return {state_.time, state_.step, state_.time_step, state_.iterations}; }
  StepProposal ProposeStep(const Controls&, double end) override { return solver_.ProposeStep(state_, end); }
  StepOutcome Step(const Controls&, const Controls& next, double dt) override {
    return OutcomeOf(solver_.Step(state_, next, dt));
  }

  double LargestSpeed() const override {
    double largest = 0;
    for (const VoxelState& body : state_.bodies) {
      for (std::int32_t n = 0; n < body.displacement.nodes(); ++n) {
        largest = std::max(largest, (body.displacement.At(n) - body.previous.At(n)).norm());
      }
    }
    return state_.time_step > 0 ? largest / state_.time_step : 0;
  }

  std::vector<BodyFrame> MeasureBodies(const Controls&, const Controls&) const override {
    return MeasureVoxelBodies(scene_, solver_, state_);
  }
  std::vector<double> ElementValues(std::size_t body, OutputField field, const Controls&,
                                    const Controls&) const override {
    return VoxelValuesOf(solver_, state_, body, field);
  }
  std::vector<Reaction> Reactions(const Controls&, const Controls&) const override {
    std::vector<Reaction> reactions;
    for (const std::vector<Reaction>& of_body : state_.reactions) {
      reactions.insert(reactions.end(), of_body.begin(), of_body.end());
    }
    return reactions;
  }
  std::vector<double> MeasureSeries(const Controls& now, const std::vector<Reaction>& reactions,
                                    std::int64_t iterations_before) const override {
    return MeasureVoxelSeries(scene_, solver_, state_, now, reactions, iterations_before);
  }
  std::vector<double> MeasureLaterSeries(const Controls&, const std::vector<Reaction>& reactions) const override {
    return MeasureVoxelLaterSeries(scene_, solver_, state_, reactions);
  }

  void Save(ArchiveWriter& archive) const override { state_.Save(archive); }
  void Load(ArchiveReader& archive) override { state_.Load(archive); }

 private:
  static StepOutcome OutcomeOf(const VoxelSolveReport& report) {
    StepOutcome outcome = {report.problem, {report.body, {}, false}};
    outcome.residual = report.residual;
    return outcome;
  }

  const Scene& scene_;
  VoxelSolver solver_;
  VoxelSceneState state_;
};

}  // namespace

std::unique_ptr<MethodRun> MakeVoxelRun(const Scene& scene, ThreadTeam& team, Profile* profile) {
  return std::make_unique<VoxelMethodRun>(scene, team, profile);
}

}  // namespace fascicle
