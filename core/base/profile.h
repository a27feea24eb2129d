#ifndef FASCICLE_CORE_BASE_PROFILE_H_
#define FASCICLE_CORE_BASE_PROFILE_H_

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

namespace fascicle {

// One stage of a Profile.
struct ProfileStage {
  std::string name;        // path of names from the outermost stage: "step/elastic force"
  std::int64_t calls = 0;  // how often it was entered
  double seconds = 0;      // wall time, nested stages included [s]
};

// Measures where the time of one thread goes: a tree of stages, each entered and left by a StageTimer. A stage costs
// less than 0.2 us and never allocates, so profiles are always on. One thread enters stages. Any thread may read at any
// time; what it reads lags by at most one call of a stage.
class Profile {
 public:
  // Construct in the thread whose stages are timed; its processor time counts from now on.
  Profile();
  // For a thread that has already used `cpu_before` [s] of processor time (0 for one that has not started).
  explicit Profile(double cpu_before);
  Profile(const Profile&) = delete;
  Profile& operator=(const Profile&) = delete;

  // Each stage before its children, otherwise in the order in which they were first entered. An active stage counts up
  // to now.
  std::vector<ProfileStage> Stages() const;
  // Since construction [s].
  double wall_seconds() const;

  // Records the processor time of the calling thread, which must be the timed one, plus `others` [s] of its helper
  // threads.
  void NoteCpu(double others = 0);
  // The value last recorded [s].
  double cpu_seconds() const { return cpu_seconds_.load(std::memory_order_relaxed); }

 private:
  friend class StageTimer;

  // Stages beyond this number are counted within their parent.
  static constexpr int kMaxStages = 64;
  static constexpr int kRoot = -1;

  struct Stage {
    const char* name = nullptr;
    int parent = kRoot;  // less than its own index
    std::atomic<std::int64_t> calls = 0;
    std::atomic<std::int64_t> nanoseconds = 0;  // total of the completed calls
    std::atomic<std::int64_t> since = 0;        // [ns] when the current call began; 0: not active
  };

  int Find(const char* name);
  bool Enter(const char* name);
  void Leave();
  void AddStages(int parent, const std::string& prefix, std::int64_t now, std::vector<ProfileStage>& stages) const;

  const std::int64_t start_;  // [ns]
  const double cpu_before_;
  std::atomic<double> cpu_seconds_ = 0;
  std::array<Stage, kMaxStages> stages_;
  std::atomic<int> count_ = 0;
  int current_ = kRoot;
};

// Times a stage of `profile` for as long as this object lives; the stage is nested in the thread's current one. `name`
// must outlive the profile (use a literal) and contain no slash. Does nothing if `profile` is null.
class StageTimer {
 public:
  StageTimer(Profile* profile, const char* name)
      : profile_(profile != nullptr && profile->Enter(name) ? profile : nullptr) {}
  ~StageTimer() {
    if (profile_ != nullptr) profile_->Leave();
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  Profile* const profile_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_PROFILE_H_
