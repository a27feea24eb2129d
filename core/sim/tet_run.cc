#include "core/sim/tet_run.h"

#include <utility>

#include "core/sim/tet_measure.h"
#include "core/tet/diagnostics.h"
#include "core/tet/fields.h"
#include "core/tet/solver.h"

namespace fascicle {
namespace {

class TetRun : public MethodRun {
 public:
  TetRun(const Scene& scene, ThreadTeam& team, Profile* profile)
      : team_(team), model_(scene, team.stop()), solver_(model_, team, profile) {}

  std::vector<SeriesInfo> Series() const override { return SeriesOf(model_); }
  std::vector<SeriesInfo> LaterSeries() const override { return LaterSeriesOf(model_); }

  void Start(const Controls& start) override { state_ = solver_.InitialState(start); }
  StepOutcome SolveStart(const Controls& start) override {
    return model_.scene().start.equilibrium ? OutcomeOf(solver_.SolveEquilibrium(start, state_)) : StepOutcome();
  }
  RunClock clock() const override { return {state_.time, state_.step, state_.time_step, state_.iterations}; }
  StepProposal ProposeStep(const Controls& now, double end) override { return solver_.ProposeStep(state_, now, end); }
  StepOutcome Step(const Controls& now, const Controls& next, double dt) override {
    return OutcomeOf(solver_.Step(state_, now, next, dt));
  }

  double LargestSpeed() const override { return fascicle::LargestSpeed(state_.velocities); }

  std::vector<HigherOrderNodes> HigherOrder() const override { return HigherOrderNodesOf(model_); }
  std::vector<BodyFrame> MeasureBodies(const Controls& now, const Controls& later) const override {
    return fascicle::MeasureBodies(model_, state_, {now, later}, team_);
  }
  std::vector<double> ElementValues(std::size_t body, OutputField field, const Controls& now,
                                    const Controls& later) const override {
    return FieldValuesOf(model_, body, field, state_, {now, later}, team_);
  }
  std::vector<Reaction> Reactions(const Controls& now, const Controls& later) const override {
    return fascicle::Reactions(model_, state_, now, later, team_);
  }
  std::vector<double> MeasureSeries(const Controls& now, const std::vector<Reaction>& reactions,
                                    std::int64_t iterations_before) const override {
    return fascicle::MeasureSeries(model_, state_, now, reactions, iterations_before, team_);
  }
  std::vector<double> MeasureLaterSeries(const Controls& now, const std::vector<Reaction>& reactions) const override {
    return fascicle::MeasureLaterSeries(model_, state_, now, reactions, team_);
  }

  void Save(ArchiveWriter& archive) const override { state_.Save(archive); }
  void Load(ArchiveReader& archive) override { state_.Load(archive); }

 private:
  static StepOutcome OutcomeOf(StepReport report) {
    StepOutcome outcome = {report.problem, std::move(report.bad), report.try_shorter};
    outcome.residual = report.residual;
    outcome.largest_strain = report.strain.value;
    outcome.strained_body = report.strain.body;
    outcome.strained_element = report.strain.element;
    return outcome;
  }

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
