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
  std::string name;        // after those of the stages that it is part of: "step/elastic force"
  std::int64_t calls = 0;  // times it was entered
  double seconds = 0;      // wall time, with that of its parts [s]
};

// Where the time of one thread goes: a tree of stages, each entered and left by a StageTimer. A stage costs less than
// 0.2 us and never allocates, so a profile is always on. One thread enters stages; any thread may read at any time, and
// what it reads is at most one call of a stage behind.
class Profile {
 public:
  // In the thread whose stages are timed: its processor time counts from now.
  Profile();
  // For a thread that has used `cpu_before` [s] of processor time: 0 for one that is yet to be started.
  explicit Profile(double cpu_before);
  Profile(const Profile&) = delete;
  Profile& operator=(const Profile&) = delete;

  // Each stage before its parts, otherwise in the order in which they were first entered. A stage that is at work
  // counts up to now.
  std::vector<ProfileStage> Stages() const;
  // Since construction [s].
  double wall_seconds() const;

  // Notes the processor time of the calling thread, whose stages are timed, with that of `others` [s] who helped it.
  void NoteCpu(double others = 0);
  // As noted last [s].
  double cpu_seconds() const { return cpu_seconds_.load(std::memory_order_relaxed); }

 private:
  friend class StageTimer;

  // More than that are not told apart from what they are part of.
  static constexpr int kMaxStages = 64;
  static constexpr int kRoot = -1;

  struct Stage {
    const char* name = nullptr;
    int parent = kRoot;  // less than its own index
    std::atomic<std::int64_t> calls = 0;
    std::atomic<std::int64_t> nanoseconds = 0;  // of the calls that have ended
    std::atomic<std::int64_t> since = 0;        // [ns] when it was entered; 0: not at work
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

// The calling thread is in a stage of `profile` as long as this lives: part of the stage it was in before. `name` must
// outlive the profile (a literal) and hold no slash. Without a profile nothing happens.
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
