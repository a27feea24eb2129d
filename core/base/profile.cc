#include "core/base/profile.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <ctime>

namespace fascicle {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;

std::int64_t Now() { return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double CpuOfThisThread() {
  timespec time = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Only one thread writes: cheaper than fetch_add.
void Add(std::atomic<std::int64_t>& sum, std::int64_t term, std::memory_order order = kRelaxed) {
  sum.store(sum.load(kRelaxed) + term, order);
}

}  // namespace

Profile::Profile() : Profile(CpuOfThisThread()) {}

Profile::Profile(double cpu_before) : start_(Now()), cpu_before_(cpu_before) {}

double Profile::wall_seconds() const { return 1e-9 * static_cast<double>(Now() - start_); }

void Profile::NoteCpu(double others) { cpu_seconds_.store(CpuOfThisThread() - cpu_before_ + others, kRelaxed); }

// The child `name` of the current stage, or kRoot where there is none.
int Profile::Find(const char* name) {
  const int count = count_.load(kRelaxed);
  for (int i = current_ + 1; i < count; ++i) {
    const Stage& stage = stages_[static_cast<std::size_t>(i)];
    if (stage.parent == current_ && (stage.name == name || std::strcmp(stage.name, name) == 0)) return i;
  }
  if (count == kMaxStages) return kRoot;
  Stage& stage = stages_[static_cast<std::size_t>(count)];
  stage.name = name;
  stage.parent = current_;
  count_.store(count + 1, std::memory_order_release);
  return count;
}

bool Profile::Enter(const char* name) {
  const int found = Find(name);
  if (found == kRoot) return false;
  current_ = found;
  Stage& stage = stages_[static_cast<std::size_t>(found)];
  Add(stage.calls, 1);
  stage.since.store(Now(), kRelaxed);
  return true;
}

void Profile::Leave() {
  Stage& stage = stages_[static_cast<std::size_t>(current_)];
  const std::int64_t elapsed = Now() - stage.since.load(kRelaxed);
  // Readers load in the opposite order: they may miss this call but never count it twice.
  stage.since.store(0, kRelaxed);
  Add(stage.nanoseconds, elapsed, std::memory_order_release);
  current_ = stage.parent;
}

void Profile::AddStages(int parent, const std::string& prefix, std::int64_t now,
                        std::vector<ProfileStage>& stages) const {
  const int count = count_.load(std::memory_order_acquire);
  for (int i = parent + 1; i < count; ++i) {
    const Stage& stage = stages_[static_cast<std::size_t>(i)];
    if (stage.parent != parent) continue;
    const std::int64_t ended = stage.nanoseconds.load(std::memory_order_acquire);
    const std::int64_t since = stage.since.load(kRelaxed);
    const std::int64_t under_way = since == 0 ? 0 : std::max<std::int64_t>(now - since, 0);
    stages.push_back({prefix + stage.name, stage.calls.load(kRelaxed), 1e-9 * static_cast<double>(ended + under_way)});
    AddStages(i, prefix + stage.name + "/", now, stages);
  }
}

std::vector<ProfileStage> Profile::Stages() const {
  std::vector<ProfileStage> stages;
  AddStages(kRoot, "", Now(), stages);
  return stages;
}

}  // namespace fascicle
