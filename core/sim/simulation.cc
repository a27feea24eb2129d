#include "core/sim/simulation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/archive.h"
#include "core/scene/curves.h"
#include "core/sim/fingerprint.h"
#include "core/sim/floor_bodies.h"
#include "core/sim/method_run.h"

namespace fascicle {
namespace {

constexpr const char* kCheckpointKind = "fascicle checkpoint";
constexpr std::uint32_t kCheckpointVersion = 2;

struct ProblemText {
  const char* reason;
  const char* message;
  const char* advice;
};

ProblemText TextOf(StepProblem problem) {
  switch (problem) {
    case StepProblem::kInvertedElement:
      return {"INVERTED_ELEMENT", "elements turn inside out, also with the step cut to a thousandth",
              "load, move or activate more slowly, use a smaller safety, a finer mesh where it bends, or a law that "
              "resists compression"};
    case StepProblem::kNotFinite:
      return {"NOT_FINITE", "stresses are not finite numbers, also with the step cut to a thousandth",
              "check loads and material parameters for their units"};
    case StepProblem::kNotConverged:
      return {"NOT_CONVERGED", "the linear solve of the damping did not reach its tolerance",
              "use a larger solver_tolerance or less damping"};
    case StepProblem::kNotSolved:
      return {"NOT_CONVERGED", "the conjugate gradients did not reach their tolerance",
              "use a larger tolerance, a smaller contrast of stiffness, or remove parts that hang on single voxels"};
    case StepProblem::kVelocitiesNotFound:
      return {"NOT_CONVERGED", "no velocities were found that keep the volumes and move as supports do",
              "use a larger stabilization or a smaller time_step, or an explicit elastic_force"};
    case StepProblem::kLeftGrid:
      return {"LEFT_GRID", "the body has come to the side of its grid",
              "give it a larger margin, or a larger room by lowest and highest"};
    case StepProblem::kNoEquilibrium:
      return {
          "NOT_CONVERGED", "no equilibrium was found, also with the step cut to a few thousandths",
          "the elements named are the furthest from it: see whether the body can hold this load there; load, move or "
          "activate more slowly, or use a stepping with inertia (backward_euler), which follows a body that snaps"};
    case StepProblem::kUnstable:
      return {"STEP_TOO_SMALL", "the motion gains energy, also with the step cut to a thousandth",
              "leave time_step out, so that a stable step is found, or use a smaller safety"};
    default:
      return {"STEP_TOO_SMALL", "the stable step has become too small to get on",
              "the elements named are the thinnest: load or move more slowly, repair the mesh there, or use a lower "
              "bulk modulus or a higher density"};
  }
}

}  // namespace

struct Simulation::Impl {
  Impl(std::shared_ptr<const Scene> s, int threads, Profile* p)
      : profile(p),
        scene(std::move(s)),
        team(threads),
        method(MakeMethodRun(*scene, team, p)),
        layout{FloorBodies(*scene), {}, method->Series()} {
    const double intervals = scene->duration / scene->output.frame_interval;
    // The allowance keeps rounding from adding a frame to a whole number of intervals.
    last_frame = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(intervals * (1 - 1e-12))));
  }

  ~Impl() { NoteCpu(); }

  void NoteCpu() {
    if (profile != nullptr) profile->NoteCpu(team.others_cpu_seconds());
  }

  void Start() {
    method->Start();
    next_frame = 0;
    iterations_at_frame = 0;
    settled = false;
  }

  double TimeOfFrame(std::int64_t frame) const {
    return frame >= last_frame ? scene->duration : static_cast<double>(frame) * scene->output.frame_interval;
  }

  bool AtEnd() const { return settled || next_frame > last_frame; }

  bool IsSettled() const {
    const RunClock clock = method->clock();
    return scene->output.settle_speed && clock.step > 0 && clock.time >= curves_end &&
           method->LargestSpeed() <= *scene->output.settle_speed;
  }

  Frame TakeFrame() {
    const StageTimer timer(profile, "frame");
    const RunClock clock = method->clock();
    Frame frame;
    frame.index = next_frame;
    frame.time = clock.time;
    frame.step = clock.step;
    {
      const StageTimer fields(profile, "fields");
      frame.bodies = method->MeasureBodies();
    }
    {
      const StageTimer series_timer(profile, "series");
      frame.series = method->MeasureSeries(iterations_at_frame);
    }
    {
      const StageTimer digest(profile, "digest");
      frame.digest = DigestOf(frame);
    }
    ++next_frame;
    iterations_at_frame = clock.iterations;
    settled = IsSettled();
    return frame;
  }

  std::string Checkpoint() const {
    const StageTimer timer(profile, "checkpoint");
    ArchiveWriter archive(kCheckpointKind, kCheckpointVersion);
    archive.PutString("scene", Hex(fingerprint));
    archive.PutInt("next_frame", next_frame);
    archive.PutInt("iterations_at_frame", iterations_at_frame);
    archive.PutInt("settled", settled ? 1 : 0);
    method->Save(archive);
    return archive.Finish();
  }

  bool Restore(std::string_view checkpoint) {
    ArchiveReader archive(checkpoint, kCheckpointKind, kCheckpointVersion);
    if (archive.GetString("scene") != Hex(fingerprint)) return false;
    next_frame = archive.GetInt("next_frame");
    iterations_at_frame = archive.GetInt("iterations_at_frame");
    settled = archive.GetInt("settled") != 0;
    method->Load(archive);
    return archive.AtEnd();
  }

  StepOutcome Step(double end, const std::stop_token& stop) {
    const StageTimer timer(profile, "step");
    return method->Advance(end, stop);
  }

  // How the run ends with a step; not at all when it was made.
  std::optional<Outcome> Ended(const StepOutcome& step) const {
    if (step.problem == StepProblem::kNone) return std::nullopt;
    if (step.problem == StepProblem::kStopped) return Outcome{Outcome::Kind::kCancelled, {}};
    return Outcome{Outcome::Kind::kFailed, FailureOf(step)};
  }

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
    const ProblemText text = TextOf(outcome.problem);
    const RunClock clock = method->clock();
    return {text.reason,          text.message,      clock.step,
            clock.time,           ObjectKind::kBody, scene->bodies[outcome.bad.body].name,
            outcome.bad.elements, text.advice};
  }

  Profile* const profile;
  std::shared_ptr<const Scene> scene;
  ThreadTeam team;
  std::unique_ptr<MethodRun> method;
  FrameLayout layout;
  Digest fingerprint = FingerprintOf(*scene);
  const double curves_end = CurvesEnd(*scene);
  std::int64_t last_frame = 0;

  std::int64_t next_frame = 0;
  std::int64_t iterations_at_frame = 0;
  bool settled = false;
};

Simulation::Simulation(std::shared_ptr<const Scene> scene, int threads, Profile* profile)
    : impl_(std::make_unique<Impl>(std::move(scene), threads, profile)) {
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

Outcome Simulation::Run(FrameSink& sink, std::stop_token stop, std::chrono::milliseconds checkpoint_interval) {
  using Clock = std::chrono::steady_clock;
  Impl& run = *impl_;
  Clock::time_point last_checkpoint = Clock::now();
  if (run.next_frame == 0) {
    if (const auto ended = run.Ended(run.method->SolveStart(stop))) return *ended;
  }
  while (!run.AtEnd()) {
    const double frame_time = run.TimeOfFrame(run.next_frame);
    while (run.method->clock().time < frame_time) {
      if (stop.stop_requested()) return {Outcome::Kind::kCancelled, {}};
      if (const auto ended = run.Ended(run.Step(frame_time, stop))) return *ended;
      sink.PutProgress(run.ProgressNow());
    }
    Frame frame = run.TakeFrame();
    std::string checkpoint;
    if (run.AtEnd() || Clock::now() - last_checkpoint >= checkpoint_interval) {
      checkpoint = run.Checkpoint();
      last_checkpoint = Clock::now();
    }
    if (!run.Put(sink, std::move(frame), std::move(checkpoint))) {
      return {Outcome::Kind::kFailed,
              {"STORAGE",
               "a frame could not be stored",
               run.method->clock().step,
               run.method->clock().time,
               ObjectKind::kNone,
               {},
               {},
               "make room where results are kept, then start the job again"}};
    }
  }
  return {Outcome::Kind::kSucceeded, {}};
}

}  // namespace fascicle
