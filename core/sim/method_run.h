#ifndef FASCICLE_CORE_SIM_METHOD_RUN_H_
#define FASCICLE_CORE_SIM_METHOD_RUN_H_

#include <cstdint>
#include <memory>
#include <stop_token>
#include <vector>

#include "core/base/archive.h"
#include "core/base/parallel.h"
#include "core/base/profile.h"
#include "core/base/step_problem.h"
#include "core/scene/scene.h"
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
  BadElements bad;  // where, when it could not be made
};

// What Simulation asks of a method: its model of a scene, its solver, and the state of the run. One thread at a time.
class MethodRun {
 public:
  virtual ~MethodRun() = default;

  virtual std::vector<SeriesInfo> Series() const = 0;

  // At time 0, or to be loaded; to be called before anything below.
  virtual void Start() = 0;
  // Solves for time 0 where the scene asks for equilibrium; unless a checkpoint was loaded, before the first frame.
  virtual StepOutcome SolveStart(std::stop_token stop) = 0;
  virtual RunClock clock() const = 0;
  // Makes one step towards `end` [s], which it never passes and hits exactly. On a problem the state stays as it is.
  virtual StepOutcome Advance(double end, std::stop_token stop) = 0;

  // Largest speed of a node [m/s].
  virtual double LargestSpeed() const = 0;

  // Positions and the fields that the scene asks for, of every body.
  virtual std::vector<BodyFrame> MeasureBodies() const = 0;
  // One value for each of Series(). `iterations_before`: of the clock at the frame before.
  virtual std::vector<double> MeasureSeries(std::int64_t iterations_before) const = 0;

  virtual void Save(ArchiveWriter& archive) const = 0;
  virtual void Load(ArchiveReader& archive) = 0;
};

// The method that the scene names. Scene (checked), team and profile, if there is one, must outlive the run.
std::unique_ptr<MethodRun> MakeMethodRun(const Scene& scene, ThreadTeam& team, Profile* profile);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_METHOD_RUN_H_
