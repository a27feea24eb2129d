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

  void Start() override { state_ = solver_.InitialState(); }
  StepOutcome SolveStart(std::stop_token stop) override {
    return OutcomeOf(solver_.SolveStart(state_, std::move(stop)));
  }
  RunClock clock() const override { return {state_.time, state_.step, state_.time_step, state_.iterations}; }
  StepOutcome Advance(double end, std::stop_token stop) override {
    return OutcomeOf(solver_.Advance(state_, end, std::move(stop)));
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

  std::vector<BodyFrame> MeasureBodies() const override { return MeasureVoxelBodies(scene_, solver_, state_); }
  std::vector<double> MeasureSeries(std::int64_t iterations_before) const override {
    return MeasureVoxelSeries(scene_, solver_, state_, iterations_before);
  }

  void Save(ArchiveWriter& archive) const override { state_.Save(archive); }
  void Load(ArchiveReader& archive) override { state_.Load(archive); }

 private:
  static StepOutcome OutcomeOf(const VoxelSolveReport& report) { return {report.problem, {report.body, {}, false}}; }

  const Scene& scene_;
  VoxelSolver solver_;
  VoxelSceneState state_;
};

}  // namespace

std::unique_ptr<MethodRun> MakeVoxelRun(const Scene& scene, ThreadTeam& team, Profile* profile) {
  return std::make_unique<VoxelMethodRun>(scene, team, profile);
}

}  // namespace fascicle
