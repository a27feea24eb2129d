#include "core/sim/tet_run.h"

#include <utility>

#include "core/sim/tet_measure.h"
#include "core/tet/diagnostics.h"
#include "core/tet/solver.h"

namespace fascicle {
namespace {

class TetRun : public MethodRun {
 public:
  TetRun(const Scene& scene, ThreadTeam& team, Profile* profile)
      : team_(team), model_(scene), solver_(model_, team, profile) {}

  std::vector<SeriesInfo> Series() const override { return SeriesOf(model_); }

  void Start() override { state_ = solver_.InitialState(); }
  StepOutcome SolveStart(std::stop_token) override { return {}; }
  RunClock clock() const override { return {state_.time, state_.step, state_.time_step, state_.iterations}; }
  StepOutcome Advance(double end, std::stop_token stop) override {
    StepReport report = solver_.Advance(state_, end, std::move(stop));
    return {report.problem, std::move(report.bad)};
  }

  double LargestSpeed() const override { return fascicle::LargestSpeed(state_.velocities); }

  std::vector<BodyFrame> MeasureBodies() const override { return fascicle::MeasureBodies(model_, state_, team_); }
  std::vector<double> MeasureSeries(std::int64_t iterations_before) const override {
    return fascicle::MeasureSeries(model_, state_, iterations_before, team_);
  }

  void Save(ArchiveWriter& archive) const override { state_.Save(archive); }
  void Load(ArchiveReader& archive) override { state_.Load(archive); }

 private:
  ThreadTeam& team_;
  TetModel model_;
  TetSolver solver_;
  TetState state_;
};

}  // namespace

std::unique_ptr<MethodRun> MakeTetRun(const Scene& scene, ThreadTeam& team, Profile* profile) {
  return std::make_unique<TetRun>(scene, team, profile);
}

}  // namespace fascicle
