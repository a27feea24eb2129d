#ifndef FASCICLE_CORE_SIM_METHOD_RUN_H_
#define FASCICLE_CORE_SIM_METHOD_RUN_H_

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/archive.h"
#include "core/base/parallel.h"
#include "core/base/profile.h"
#include "core/base/step_problem.h"
#include "core/scene/controls.h"
#include "core/sim/frame.h"

namespace fascicle {

// Where a run stands.
struct RunClock {
  double time = 0;  // [s]
  std::int64_t step = 0;
  double time_step = 0;         // of the last step [s]
  std::int64_t iterations = 0;  // of linear solves, or of Newton's method, so far
};

// How a step ended.
struct StepOutcome {
  StepProblem problem = StepProblem::kNone;
  BadElements bad;           // where, when it could not be made
  bool try_shorter = false;  // it could not be made, but ProposeStep has a shorter one
};

// What Simulation asks of a method: its model of a scene, its solver, and the state of the run. Simulation has the
// clock: it asks for a step's length, evaluates the controls at both ends, and has the step made, which takes all
// bodies of the scene along. Not thread-safe. All of it may end early by Stopped (core/base/stop.h), as the team
// does; the state is then that after the last whole step.
class MethodRun {
 public:
  virtual ~MethodRun() = default;

  virtual std::vector<SeriesInfo> Series() const = 0;

  // At time 0, or to be loaded; to be called before anything below. start: the controls at time 0.
  virtual void Start(const Controls& start) = 0;
  // Solves for time 0 where the scene asks for equilibrium; unless a checkpoint was loaded, before the first frame.
  virtual StepOutcome SolveStart(const Controls& start) = 0;
  virtual RunClock clock() const = 0;

  // The next step towards `end` [s], which it never passes and hits exactly. now: the controls at the clock's time.
  virtual StepProposal ProposeStep(const Controls& now, double end) = 0;
  // Makes a step of dt [s], no longer than the one that was proposed last, to the time of `next`. On a problem the
  // state keeps its time and motion.
  virtual StepOutcome Step(const Controls& now, const Controls& next, double dt) = 0;

  // Largest speed of a node [m/s].
  virtual double LargestSpeed() const = 0;

  // Positions and the fields that the scene asks for, of every body. now: the controls at the clock's time.
  virtual std::vector<BodyFrame> MeasureBodies(const Controls& now) const = 0;
  // The force of each constraint of each body on it, in the scene's order [N]. later: the controls after another step
  // as long as the last one.
  virtual std::vector<Vec3> Reactions(const Controls& now, const Controls& later) const = 0;
  // One value for each of Series(). `reactions`: as above. `iterations_before`: of the clock at the frame before.
  virtual std::vector<double> MeasureSeries(const Controls& now, const std::vector<Vec3>& reactions,
                                            std::int64_t iterations_before) const = 0;

  virtual void Save(ArchiveWriter& archive) const = 0;
  virtual void Load(ArchiveReader& archive) = 0;
};

// The method that the scene names. Scene (checked), team and profile, if there is one, must outlive the run.
std::unique_ptr<MethodRun> MakeMethodRun(const Scene& scene, ThreadTeam& team, Profile* profile);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_METHOD_RUN_H_
