#ifndef FASCICLE_SERVER_JOBS_JOB_STEERING_H_
#define FASCICLE_SERVER_JOBS_JOB_STEERING_H_

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/sim/steering.h"
#include "server/jobs/job_manager.h"
#include "server/store/store.h"

namespace fascicle::server {

// The inputs of a job that has not ended: accepts them from clients and gives them to the run. An input is stored with
// the step with which it takes effect, a later one than any that the run has begun or of which a frame is stored. A run
// that reaches that step meanwhile waits until it is stored. Thread-safe.
class JobSteering final : public SteeringSource {
 public:
  static constexpr std::int64_t kMostInputs = 10'000;

  // Call before everything else; later calls have no effect. Stores the inputs that the job's spec has already.
  void Open(std::shared_ptr<FrameStore> frames, const std::string& spec, const JobCodec& codec);

  SteeringAnswer Apply(const SteeringRequest& request, bool check_only);
  SteeringList List(std::int64_t start, int limit);

  // For the run. `step`: the number of steps that it has made. `write` calls its argument, which stores something, and
  // again when the disk was full.
  using Write = std::function<void(const std::function<void()>&)>;
  void BeginRun(std::int64_t step, const std::string& spec, const JobCodec& codec, Write write);
  std::vector<SteeringInput> Take(std::int64_t step, double time) override;
  bool TryClose() override;
  // The run has ended: there are no more inputs.
  void Close();
  // The sequence numbers of the inputs that no step of the run has taken, in ascending order.
  std::vector<std::int64_t> Unreached();

 private:
  struct Waiting {
    SteeringRecord record;
    SteeringInput input;
  };

  void CheckSequence(const SteeringRequest& request, SteeringAnswer& answer);
  void CheckTime(const SteeringRequest& request, SteeringAnswer& answer) const;  // needs mutex_
  void Store(const SteeringRecord& record);
  void Add(Waiting waiting);
  bool IsDue(const SteeringRecord& record, std::int64_t step, double time) const;

  std::mutex apply_mutex_;  // one change at a time; taken before mutex_, held during disk access; guards the next three
  std::shared_ptr<FrameStore> frames_;
  std::int64_t count_ = 0;
  bool is_running_ = false;
  Write write_;  // of the run, used by its thread only

  std::mutex mutex_;  // guards the members below; never held during disk access
  std::condition_variable changed_;
  std::int64_t begun_step_ = 0;             // no input takes effect with this step or an earlier one any more
  double begun_time_ = -1;                  // when it began, or a later time [s]
  std::optional<SteeringRecord> reserved_;  // being stored
  std::map<std::pair<std::int64_t, std::int64_t>, Waiting> by_step_;  // by step and sequence
  std::map<std::pair<double, std::int64_t>, Waiting> by_time_;        // by time and sequence
  bool is_closed_ = false;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_JOB_STEERING_H_
