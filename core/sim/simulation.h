#ifndef FASCICLE_CORE_SIM_SIMULATION_H_
#define FASCICLE_CORE_SIM_SIMULATION_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/profile.h"
#include "core/scene/scene.h"
#include "core/sim/frame.h"
#include "core/sim/steering.h"
#include "core/sim/warning.h"

namespace fascicle {

// The progress of a run.
struct Progress {
  double fraction = 0;  // completed fraction of the simulated time, 0 to 1
  double time = 0;      // [s]
  std::int64_t step = 0;
  double time_step = 0;  // [s]
};

// Kinds of objects that can fail.
enum class ObjectKind { kNone, kBody, kRigidBody, kLine, kJoint };

// Why a run could not go on. Reasons: INVERTED_ELEMENT STEP_TOO_SMALL NOT_CONVERGED NOT_FINITE
// LEFT_GRID STORAGE.
struct Failure {
  std::string reason;
  std::string message;
  std::int64_t step = 0;
  double time = 0;  // [s]
  ObjectKind object_kind = ObjectKind::kNone;
  std::string object;                  // its name; empty when none in particular
  std::vector<std::int64_t> elements;  // of a body; at most 16
  std::string advice;
};

struct Outcome {
  enum class Kind { kSucceeded, kFailed, kCancelled };
  Kind kind = Kind::kSucceeded;
  Failure failure;  // for kFailed
  std::vector<Warning> warnings = {};
};

// A line of a run's log. Plain data, without wall times: a repeated run writes the same.
struct LogLine {
  // Steps; a step that failed and is made shorter; a frame; an input that takes effect; a warning; the run's failure.
  enum class Kind { kStep, kCut, kFrame, kInput, kWarning, kFailure };
  Kind kind = Kind::kStep;
  std::int64_t step = 0;                  // number of steps made; of an input: the step with which it takes effect
  double time = 0;                        // [s]
  std::int64_t steps = 0;                 // number of steps that it sums up
  double time_step = 0;                   // of the last step, or of the one that failed [s]
  std::int64_t iterations = 0, cuts = 0;  // in these steps
  double residual = -1;                   // of the last step, relative as its tolerance; negative: none
  std::int64_t frame = -1;                // its index, in lines of frames
  std::int64_t sequence = 0;              // of the input
  std::string text;                       // for users, in the last three kinds and of cuts
};

// Receives the results of a run. Called from the thread that runs the simulation.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  // `checkpoint` is empty, or restores the simulation to the state right after this frame. Returning false ends the run
  // with failure STORAGE.
  virtual bool PutFrame(Frame frame, std::string checkpoint) = 0;
  // Called after every step; must be cheap.
  virtual void PutProgress(const Progress& progress) = 0;
  // A line of the log. Numbers count from 0, or from where the log was at the restored checkpoint.
  virtual void PutLine(std::int64_t /*number*/, LogLine /*line*/) {}
};

// Runs a scene: clock, controls, output policy, cancel, checkpoints, digests. The frames do not depend on the number of
// threads, nor on how often a run was interrupted and restored. Not thread-safe.
class Simulation {
 public:
  // The scene must have passed CheckScene. threads >= 1. Stages are timed in `profile`, which may be null and must
  // outlive the simulation; with a profile, the simulation must be destroyed by the thread that created it. Throws
  // Stopped (core/base/stop.h) if `stop` is requested while the model is set up.
  Simulation(std::shared_ptr<const Scene> scene, int threads, Profile* profile = nullptr, std::stop_token stop = {});
  ~Simulation();

  // What every frame holds beside the bodies of the scene.
  const FrameLayout& layout() const;

  // Continues from a checkpoint of the same scene. False if it is not one; the simulation then starts from rest.
  bool Restore(std::string_view checkpoint);

  // Index of the next frame of Run: 0, or the one after the restored checkpoint.
  std::int64_t next_frame() const;
  // Number of steps made.
  std::int64_t step() const;

  // Steps to the end of the scene. A stop request ends it with kCancelled, also within a step or a frame, which is then
  // discarded; Run can be called again. A checkpoint is written with the first frame after each `checkpoint_interval`
  // of wall time, and with the last frame. `steering` gives the inputs of the run; null: there are none.
  Outcome Run(FrameSink& sink, std::stop_token stop,
              std::chrono::milliseconds checkpoint_interval = std::chrono::seconds(2),
              SteeringSource* steering = nullptr);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_SIMULATION_H_
