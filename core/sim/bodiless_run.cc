#include "core/sim/bodiless_run.h"

namespace fascicle {
namespace {

class BodilessRun : public MethodRun {
 public:
  std::vector<SeriesInfo> Series() const override { return {}; }
  std::vector<SeriesInfo> LaterSeries() const override { return {}; }

  void Start(const Controls&) override { clock_ = {}; }
  StepOutcome SolveStart(const Controls&) override { return {}; }
  RunClock clock() const override { return clock_; }
  StepProposal ProposeStep(const Controls&, double end) override {
    StepProposal step;
    step.time = end;
    step.dt = end - clock_.time;
    return step;
  }
  StepOutcome Step(const Controls&, const Controls& next, double dt) override {
    clock_.time = next.time;
    clock_.time_step = dt;
    ++clock_.step;
    return {};
  }
  double LargestSpeed() const override { return 0; }

  std::vector<BodyFrame> MeasureBodies(const Controls&, const Controls&) const override { return {}; }
  std::vector<double> ElementValues(std::size_t, OutputField, const Controls&, const Controls&) const override {
    return {};
  }
  std::vector<Reaction> Reactions(const Controls&, const Controls&) const override { return {}; }
  std::vector<double> MeasureSeries(const Controls&, const std::vector<Reaction>&, std::int64_t) const override {
    return {};
  }
  std::vector<double> MeasureLaterSeries(const Controls&, const std::vector<Reaction>&) const override { return {}; }

  void Save(ArchiveWriter& archive) const override {
    archive.PutDoubles("clock", std::vector<double>{clock_.time, clock_.time_step});
    archive.PutInt("step", clock_.step);
  }
  void Load(ArchiveReader& archive) override {
    std::vector<double> times(2);
    archive.GetDoubles("clock", std::span<double>(times));
    clock_.time = times[0];
    clock_.time_step = times[1];
    clock_.step = archive.GetInt("step");
  }

 private:
  RunClock clock_;
};

}  // namespace

std::unique_ptr<MethodRun> MakeBodilessRun() { return std::make_unique<BodilessRun>(); }

}  // namespace fascicle
