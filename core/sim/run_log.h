#ifndef FASCICLE_CORE_SIM_RUN_LOG_H_
#define FASCICLE_CORE_SIM_RUN_LOG_H_

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/archive.h"
#include "core/sim/method_run.h"
#include "core/sim/simulation.h"
#include "core/sim/steering.h"

namespace fascicle {

// Writes the log of a run to its sink. Lines have numbers, which belong to checkpoints: a run that is repeated from one
// writes the same lines with the same numbers. Within a frame the first 20 steps have a line each, then the 30th, ...,
// 100th, 200th and so on, which sum up those before them. Not thread-safe.
class RunLog {
 public:
  // Lines go to this sink, which must outlive their calls.
  void WriteTo(FrameSink& sink) { sink_ = &sink; }

  // A step, which was made shorter `cuts` times. now: the clock after it.
  void AddStep(const RunClock& now, const StepOutcome& step, int cuts);
  // A step of length dt [s] from `now` that failed and will be made shorter.
  void AddCut(const RunClock& now, double dt, const std::string& reason);
  // The inputs that take effect with the next step.
  void AddInputs(const RunClock& now, const std::vector<SteeringInput>& inputs);
  void AddFrame(const RunClock& now, std::int64_t index);
  // Those of a body and kind that were not among earlier ones.
  void AddWarnings(const RunClock& now, const std::vector<Warning>& warnings);
  void AddFailure(const Failure& failure);

  // Right after a frame.
  void Save(ArchiveWriter& archive) const { archive.PutInt("log lines", next_number_); }
  // Continues after a frame at which there were so many lines. now: the clock at it. warnings: those of the run so far.
  void Restore(std::int64_t lines, const RunClock& now, const std::vector<Warning>& warnings);

 private:
  // What has happened since some line.
  struct Sums {
    std::int64_t steps = 0, iterations = 0, cuts = 0;
  };

  void Write(LogLine line);
  void WriteSums(LogLine line, Sums& sums);

  FrameSink* sink_ = nullptr;
  std::int64_t next_number_ = 0;
  std::int64_t iterations_ = 0;  // of the clock, as counted so far
  Sums since_line_, since_frame_;
  int cut_lines_ = 0;                                     // in this frame
  std::set<std::pair<std::string, std::string>> warned_;  // reason and body
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_RUN_LOG_H_
