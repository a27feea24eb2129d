#include "core/sim/simulation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/archive.h"
#include "core/base/stop.h"
#include "core/sim/control_source.h"
#include "core/sim/fingerprint.h"
#include "core/sim/method_run.h"
#include "core/sim/rigid_bodies.h"
#include "core/sim/run_log.h"
#include "core/sim/run_warnings.h"
#include "core/sim/skeleton_measure.h"

namespace fascicle {
namespace {

constexpr const char* kCheckpointKind = "fascicle checkpoint";
constexpr std::uint32_t kCheckpointVersion = 6;

struct ProblemText {
  const char* reason;
  const char* message;
  const char* advice;
};

// Advice names only fields that the method has.
const char* AdviceOnInvertedElements(Method method) {
  switch (method) {
    case Method::kTet:
      return "load, move or activate more slowly, use a smaller safety, a finer mesh where it bends, or a law that "
             "resists compression";
    case Method::kVoxel:
      return "load, move or activate more slowly, use a smaller time_step, or a stiffer law";
    case Method::kEulerian:
      return "load, move or activate more slowly, use a smaller time_step or cell_size, or a law that resists "
             "compression";
  }
  return "";
}

ProblemText TextOf(StepProblem problem, Method method) {
  switch (problem) {
    case StepProblem::kInvertedElement:
      return {"INVERTED_ELEMENT", "elements are inverted, even with the step reduced to a thousandth",
              AdviceOnInvertedElements(method)};
    case StepProblem::kNotFinite:
      return {"NOT_FINITE", "stresses are not finite, even with the step reduced to a thousandth",
              "check the units of loads and material parameters"};
    case StepProblem::kNotConverged:
      return {"NOT_CONVERGED", "the linear solve of the damping did not reach its tolerance",
              "use a larger solver_tolerance or less damping"};
    case StepProblem::kNotSolved:
      return {"NOT_CONVERGED", "the conjugate gradients did not reach their tolerance",
              "use a larger tolerance, a smaller contrast of stiffness, or remove parts that are connected by single "
              "voxels"};
    case StepProblem::kVelocitiesNotFound:
      return {"NOT_CONVERGED", "no velocities were found that satisfy volume constraints and supports",
              "use a larger stabilization or a smaller time_step, or an explicit elastic_force"};
    case StepProblem::kLeftGrid:
      return {"LEFT_GRID", "the body has reached the boundary of its grid",
              "use a larger margin, or a larger grid by lowest and highest"};
    case StepProblem::kNoEquilibrium:
      return {
          "NOT_CONVERGED", "no equilibrium was found, even with the step reduced to a few ten-thousandths",
          "the listed elements are farthest from it: check whether the body can bear this load there; load, move or "
          "activate more slowly, or use a stepping with inertia (backward_euler), which can simulate snap-through"};
    case StepProblem::kInaccurate:
      return {"STEP_TOO_SMALL",
              "the error of a step exceeds step_error, even with the step reduced to a few "
              "ten-millionths",
              "use a larger step_error, or let loads and motions change gradually: no step across a jump is accurate"};
    case StepProblem::kUnstable:
      return {"STEP_TOO_SMALL", "the motion gains energy, even with the step reduced to a thousandth",
              "omit time_step to use a stable step, or use a smaller safety"};
    case StepProblem::kNone:
    case StepProblem::kStepTooSmall:
      break;
  }
  return {"STEP_TOO_SMALL", "the stable step has become too small",
          "the listed elements are the thinnest: load or move more slowly, repair the mesh there, or use a lower "
          "bulk modulus or a higher density"};
}

}  // namespace

struct Simulation::Impl {
  Impl(std::shared_ptr<const Scene> s, int threads, Profile* p, std::stop_token stop)
      : profile(p),
        scene(std::move(s)),
        team(threads, std::move(stop)),
        source(*scene),
        method(MakeMethodRun(*scene, team, p)),
        layout{RigidBodiesOf(*scene), {}, SeriesOf(*method), method->HigherOrder()},
        warnings(*scene, layout.series) {
    if (scene->skeleton) skeleton.emplace(*scene).AddTo(layout);
    const double intervals = scene->duration / scene->output.frame_interval;
    // The tolerance prevents rounding from adding a frame to a whole number of intervals.
    last_frame = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(intervals * (1 - 1e-12))));
  }

  ~Impl() { NoteCpu(); }

  static std::vector<SeriesInfo> SeriesOf(const MethodRun& method) {
    std::vector<SeriesInfo> series = method.Series();
    const std::vector<SeriesInfo> later = method.LaterSeries();
    series.insert(series.end(), later.begin(), later.end());
    return series;
  }

  void NoteCpu() {
    if (profile != nullptr) profile->NoteCpu(team.others_cpu_seconds());
  }

  void Start() {
    source = ControlSource(*scene);
    warnings = RunWarnings(*scene, layout.series);
    source.Evaluate(0, now);
    method->Start(now);
    next_frame = 0;
    iterations_at_frame = 0;
    settled = false;
    log = {};
  }

  double TimeOfFrame(std::int64_t frame) const {
    return frame >= last_frame ? scene->duration : static_cast<double>(frame) * scene->output.frame_interval;
  }

  bool AtEnd() const { return settled || next_frame > last_frame; }

  bool IsSettled() {
    const RunClock clock = method->clock();
    return scene->output.settle_speed && clock.step > 0 && source.RestsAt(clock.time) &&
           method->LargestSpeed() <= *scene->output.settle_speed && (steering == nullptr || steering->TryClose());
  }

  Frame TakeFrame() {
    const StageTimer timer(profile, "frame");
    const RunClock clock = method->clock();
    Frame frame;
    frame.index = next_frame;
    frame.time = clock.time;
    frame.step = clock.step;
    frame.poses = PosesOf(*scene, now);
    source.Evaluate(clock.time + clock.time_step, next);
    {
      const StageTimer fields(profile, "fields");
      frame.bodies = method->MeasureBodies(now, next);
    }
    {
      const StageTimer series_timer(profile, "series");
      const std::vector<Reaction> reactions = method->Reactions(now, next);
      frame.series = method->MeasureSeries(now, reactions, iterations_at_frame);
      const std::vector<double> later = method->MeasureLaterSeries(now, reactions);
      frame.series.insert(frame.series.end(), later.begin(), later.end());
      if (skeleton) skeleton->Measure(reactions, frame);
    }
    {
      const StageTimer digest(profile, "digest");
      frame.digest = DigestOf(frame);
    }
    {
      const StageTimer warning_timer(profile, "warnings");
      warnings.ObserveFrame(frame, *method, now, next);
    }
    log.AddWarnings(clock, warnings.List());
    log.AddFrame(clock, frame.index);
    ++next_frame;
    iterations_at_frame = clock.iterations;
    settled = IsSettled();
    source.DiscardBefore(clock.time);
    return frame;
  }

  std::string Checkpoint() const {
    const StageTimer timer(profile, "checkpoint");
    ArchiveWriter archive(kCheckpointKind, kCheckpointVersion);
    archive.PutString("scene", Hex(fingerprint));
    archive.PutInt("next_frame", next_frame);
    archive.PutInt("iterations_at_frame", iterations_at_frame);
    archive.PutInt("settled", settled ? 1 : 0);
    source.Save(archive);
    warnings.Save(archive);
    log.Save(archive);
    method->Save(archive);
    return archive.Finish();
  }

  bool Restore(std::string_view checkpoint) {
    ArchiveReader archive(checkpoint, kCheckpointKind, kCheckpointVersion);
    if (archive.GetString("scene") != Hex(fingerprint)) return false;
    next_frame = archive.GetInt("next_frame");
    iterations_at_frame = archive.GetInt("iterations_at_frame");
    settled = archive.GetInt("settled") != 0;
    source.Load(archive);
    warnings.Load(archive);
    const std::int64_t log_lines = archive.GetInt("log lines");
    method->Load(archive);
    if (!archive.AtEnd()) return false;
    log.Restore(log_lines, method->clock(), warnings.List());
    source.Evaluate(method->clock().time, now);
    return true;
  }

  // Makes one step towards `end`: the proposed one, or a shorter one if that fails.
  StepOutcome Step(double end) {
    const StageTimer timer(profile, "step");
    team.ThrowIfStopped();
    for (int cuts = 0;; ++cuts) {
      const StepProposal step = method->ProposeStep(now, end);
      if (step.problem != StepProblem::kNone) return {step.problem, step.bad};
      {
        const StageTimer controls(profile, "controls");
        source.Evaluate(step.time, next);
      }
      StepOutcome outcome = method->Step(now, next, step.dt);
      if (outcome.problem == StepProblem::kNone) {
        std::swap(now, next);
        warnings.ObserveStep(outcome, step.time);
        log.AddStep(method->clock(), outcome, cuts);
      }
      if (!outcome.try_shorter) return outcome;
      log.AddCut(method->clock(), step.dt, TextOf(outcome.problem, scene->method).reason);
    }
  }

  // Lets the inputs take effect that belong to the next step.
  void TakeInputs() {
    if (steering == nullptr) return;
    const RunClock clock = method->clock();
    const std::vector<SteeringInput> inputs = steering->Take(clock.step + 1, clock.time);
    for (const SteeringInput& input : inputs) source.Steer(input, clock.time);
    log.AddInputs(clock, inputs);
  }

  // Runs from the current time to the end.
  Outcome Run(FrameSink& sink, std::chrono::milliseconds checkpoint_interval) {
    using Clock = std::chrono::steady_clock;
    Clock::time_point last_checkpoint = Clock::now();
    if (next_frame == 0) {
      const StepOutcome start = method->SolveStart(now);
      if (start.problem != StepProblem::kNone) return Failed(FailureOf(start));
      warnings.ObserveStep(start, 0);
    }
    while (!AtEnd()) {
      const double frame_time = TimeOfFrame(next_frame);
      while (method->clock().time < frame_time) {
        TakeInputs();
        const StepOutcome step = Step(frame_time);
        if (step.problem != StepProblem::kNone) return Failed(FailureOf(step));
        sink.PutProgress(ProgressNow());
      }
      Frame frame = TakeFrame();
      std::string checkpoint;
      if (AtEnd() || Clock::now() - last_checkpoint >= checkpoint_interval) {
        checkpoint = Checkpoint();
        last_checkpoint = Clock::now();
      }
      if (!Put(sink, std::move(frame), std::move(checkpoint))) return Failed(StorageFailure());
    }
    return {Outcome::Kind::kSucceeded, {}};
  }

  static Outcome Failed(Failure failure) { return {Outcome::Kind::kFailed, std::move(failure)}; }

  bool Put(FrameSink& sink, Frame frame, std::string checkpoint) {
    const StageTimer timer(profile, "waiting for storage");
    NoteCpu();
    return sink.PutFrame(std::move(frame), std::move(checkpoint));
  }

  Progress ProgressNow() const {
    const RunClock clock = method->clock();
    return {settled ? 1.0 : std::min(1.0, clock.time / scene->duration), clock.time, clock.step, clock.time_step};
  }

  Failure FailureOf(const StepOutcome& outcome) const {
    const ProblemText text = TextOf(outcome.problem, scene->method);
    const RunClock clock = method->clock();
    return {text.reason,          text.message,      clock.step,
            clock.time,           ObjectKind::kBody, scene->bodies[outcome.bad.body].name,
            outcome.bad.elements, text.advice};
  }

  Failure StorageFailure() const {
    const RunClock clock = method->clock();
    return {"STORAGE",
            "a frame could not be stored",
            clock.step,
            clock.time,
            ObjectKind::kNone,
            {},
            {},
            "free space where results are stored, then start the job again"};
  }

  Profile* const profile;
  std::shared_ptr<const Scene> scene;
  ThreadTeam team;
  ControlSource source;
  std::unique_ptr<MethodRun> method;
  FrameLayout layout;
  std::optional<SkeletonMeasure> skeleton;
  RunWarnings warnings;
  Digest fingerprint = FingerprintOf(*scene);
  std::int64_t last_frame = 0;

  SteeringSource* steering = nullptr;  // of the present Run
  RunLog log;

  Controls now, next;  // at the current time; scratch memory
  std::int64_t next_frame = 0;
  std::int64_t iterations_at_frame = 0;
  bool settled = false;
};

Simulation::Simulation(std::shared_ptr<const Scene> scene, int threads, Profile* profile, std::stop_token stop)
    : impl_(std::make_unique<Impl>(std::move(scene), threads, profile, std::move(stop))) {
  impl_->Start();
}

Simulation::~Simulation() = default;

const FrameLayout& Simulation::layout() const { return impl_->layout; }

bool Simulation::Restore(std::string_view checkpoint) {
  const bool restored = impl_->Restore(checkpoint);
  if (!restored) impl_->Start();
  return restored;
}

std::int64_t Simulation::next_frame() const { return impl_->next_frame; }

std::int64_t Simulation::step() const { return impl_->method->clock().step; }

Outcome Simulation::Run(FrameSink& sink, std::stop_token stop, std::chrono::milliseconds checkpoint_interval,
                        SteeringSource* steering) {
  Outcome outcome = {Outcome::Kind::kCancelled, {}};
  impl_->steering = steering;
  impl_->log.WriteTo(sink);
  impl_->team.HeedStop(std::move(stop));
  try {
    outcome = impl_->Run(sink, checkpoint_interval);
  } catch (const Stopped&) {
  }
  if (outcome.kind == Outcome::Kind::kFailed) {
    impl_->log.AddWarnings(impl_->method->clock(), impl_->warnings.List());
    impl_->log.AddFailure(outcome.failure);
  }
  outcome.warnings = impl_->warnings.List();
  impl_->team.HeedStop({});
  return outcome;
}

}  // namespace fascicle
