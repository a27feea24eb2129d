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
#include "core/scene/support_moment.h"
#include "core/sim/frame.h"

namespace fascicle {

// The progress of a run.
struct RunClock {
  double time = 0;  // [s]
  std::int64_t step = 0;
  double time_step = 0;         // of the last step [s]
  std::int64_t iterations = 0;  // of linear solves, or of Newton's method, so far
};

// The outcome of a step.
struct StepOutcome {
  StepProblem problem = StepProblem::kNone;
  BadElements bad;           // where it failed
  bool try_shorter = false;  // whether it failed but ProposeStep has a shorter one
  // The logarithmic strain |ln stretch| during the step that 1 % of a body exceeds, if it was without inertia; else 0.
  double largest_strain = 0;
  std::size_t strained_body = 0;
  std::int64_t strained_element = -1;
  // What is left of the forces, relative as the method's tolerance; negative if it has none.
  double residual = -1;
};

// The interface of a method for Simulation: its model of a scene, its solver, and the state of the run. Simulation
// controls the time: it asks for a proposed step, evaluates the controls at both ends, and makes the step for all
// bodies of the scene. Not thread-safe. All functions may throw Stopped (core/base/stop.h), as the team does; the state
// is then that after the last complete step.
class MethodRun {
 public:
  virtual ~MethodRun() = default;

  // The series of a frame: states, reactions and energies; then what is derived from them (moments, work, probes inside
  // of elements).
  virtual std::vector<SeriesInfo> Series() const = 0;
  virtual std::vector<SeriesInfo> LaterSeries() const = 0;

  // Sets the state at time 0. Call before anything below, also before loading. start: the controls at time 0.
  virtual void Start(const Controls& start) = 0;
  // Solves for time 0 if the scene asks for equilibrium. Call before the first frame, unless a checkpoint was loaded.
  virtual StepOutcome SolveStart(const Controls& start) = 0;
  virtual RunClock clock() const = 0;

  // The next step towards `end` [s], which it does not pass and hits exactly. now: the controls at the current time.
  virtual StepProposal ProposeStep(const Controls& now, double end) = 0;
  // Steps by dt [s], at most the last proposed step, to the time of `next`. On a problem the state keeps its time and
  // motion.
  virtual StepOutcome Step(const Controls& now, const Controls& next, double dt) = 0;

  // Largest speed of a node [m/s].
  virtual double LargestSpeed() const = 0;

  // The higher-order nodes of each body; empty if no body has any.
  virtual std::vector<HigherOrderNodes> HigherOrder() const { return {}; }

  // Positions and the requested fields of every body. now: the controls at the current time; later: those after another
  // step of the same length as the last one.
  virtual std::vector<BodyFrame> MeasureBodies(const Controls& now, const Controls& later) const = 0;
  // A field of the elements of a body, its components one after another; empty if the method has no elements.
  virtual std::vector<double> ElementValues(std::size_t body, OutputField field, const Controls& now,
                                            const Controls& later) const = 0;
  // What each constraint does to its body, in the scene's order.
  virtual std::vector<Reaction> Reactions(const Controls& now, const Controls& later) const = 0;
  // One value for each of Series(). `reactions`: see above. `iterations_before`: of the clock at the previous frame.
  virtual std::vector<double> MeasureSeries(const Controls& now, const std::vector<Reaction>& reactions,
                                            std::int64_t iterations_before) const = 0;
  // One value for each of LaterSeries().
  virtual std::vector<double> MeasureLaterSeries(const Controls& now, const std::vector<Reaction>& reactions) const = 0;

  virtual void Save(ArchiveWriter& archive) const = 0;
  virtual void Load(ArchiveReader& archive) = 0;
};

// The method of a scene. Scene (checked), team and profile (may be null) must outlive the run.
std::unique_ptr<MethodRun> MakeMethodRun(const Scene& scene, ThreadTeam& team, Profile* profile);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_METHOD_RUN_H_
