#include "core/base/parallel.h"

#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <ctime>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/check.h"

namespace fascicle {
namespace {

// Indices in one term of a sum. A constant, so that the order of additions never depends on the team.
constexpr std::size_t kSumBlock = 1024;
// Parts of a loop per thread: enough to balance the load when a thread is delayed.
constexpr std::size_t kPartsPerThread = 8;
// Polls of a flag before a thread goes to sleep: some tens of microseconds, longer than the serial code between two
// loops.
constexpr int kSpins = 2000;

void Pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

// Threads enter a loop while it is open and leave when no part is left. The caller closes the loop and waits only for
// threads inside. A thread that wakes late (on a busy machine) finds the loop closed; nobody waits for it.
struct ThreadTeam::Impl {
  // state = loop number * kLoop + (kOpen) + threads inside.
  static constexpr std::uint64_t kOpen = 1u << 16;
  static constexpr std::uint64_t kLoop = kOpen << 1;
  static constexpr std::uint64_t kInside = kOpen - 1;

  int size = 1;
  std::stop_token stop_request;
  std::vector<std::thread> threads;
  std::vector<double> terms;  // of RunSum

  // The current loop. The caller writes it while no thread is inside.
  LoopBody call = nullptr;
  const void* body = nullptr;
  std::size_t count = 0;
  std::size_t part = 1;

  alignas(64) std::atomic<std::uint64_t> state{0};
  alignas(64) std::atomic<std::size_t> next{0};
  alignas(64) std::atomic<bool> busy{false};
  std::atomic<bool> stop{false};
  std::atomic<int> sleepers{0};
  std::atomic<bool> caller_sleeps{false};
  std::mutex mutex;
  std::condition_variable loop_opened;
  std::condition_variable loop_left;

  bool HasNews(std::uint64_t last_loop) const {
    const std::uint64_t now = state.load();
    return stop.load() || ((now & kOpen) && now / kLoop != last_loop);
  }

  void RunParts() {
    while (!stop_request.stop_requested()) {
      const std::size_t begin = next.fetch_add(part, std::memory_order_relaxed);
      if (begin >= count) return;
      call(body, begin, std::min(begin + part, count));
    }
  }

  void WaitForNews(std::uint64_t last_loop) {
    for (int spin = 0; spin < kSpins; ++spin) {
      if (HasNews(last_loop)) return;
      Pause();
    }
    std::unique_lock lock(mutex);
    ++sleepers;
    loop_opened.wait(lock, [&] { return HasNews(last_loop); });
    --sleepers;
  }

  void Leave() {
    const std::uint64_t after = state.fetch_sub(1) - 1;
    if ((after & (kOpen | kInside)) == 0 && caller_sleeps.load()) {
      const std::lock_guard lock(mutex);
      loop_left.notify_one();
    }
  }

  void Work() {
    std::uint64_t last_loop = 0;
    while (true) {
      WaitForNews(last_loop);
      if (stop.load()) return;
      std::uint64_t now = state.load();
      while ((now & kOpen) && !state.compare_exchange_weak(now, now + 1)) {
      }
      if (!(now & kOpen)) continue;
      last_loop = now / kLoop;
      RunParts();
      Leave();
    }
  }

  void Open() {
    next.store(0, std::memory_order_relaxed);
    const std::uint64_t loop = state.load() / kLoop + 1;
    state.store(loop * kLoop + kOpen);
    // A thread counts itself as a sleeper before it reads the state for the last time, under the mutex. So either the
    // thread sees this loop, or this code sees the thread.
    if (sleepers.load() > 0) {
      { const std::lock_guard lock(mutex); }
      loop_opened.notify_all();
    }
  }

  void CloseAndWait() {
    state.fetch_and(~kOpen);
    const auto all_left = [&] { return (state.load() & kInside) == 0; };
    for (int spin = 0; spin < kSpins; ++spin) {
      if (all_left()) return;
      Pause();
    }
    std::unique_lock lock(mutex);
    caller_sleeps.store(true);
    loop_left.wait(lock, all_left);
    caller_sleeps.store(false);
  }
};

ThreadTeam::ThreadTeam(int threads, std::stop_token stop) : impl_(std::make_unique<Impl>()) {
  FASCICLE_CHECK(threads >= 1 && threads < static_cast<int>(Impl::kInside), "a team has at least one thread");
  impl_->size = threads;
  impl_->stop_request = std::move(stop);
  impl_->threads.reserve(threads - 1);
  for (int i = 1; i < threads; ++i) impl_->threads.emplace_back([impl = impl_.get()] { impl->Work(); });
}

ThreadTeam::~ThreadTeam() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->stop.store(true);
  }
  impl_->loop_opened.notify_all();
  for (std::thread& thread : impl_->threads) thread.join();
}

int ThreadTeam::size() const { return impl_->size; }

void ThreadTeam::HeedStop(std::stop_token stop) { impl_->stop_request = std::move(stop); }

const std::stop_token& ThreadTeam::stop() const { return impl_->stop_request; }

void ThreadTeam::ThrowIfStopped() const { fascicle::ThrowIfStopped(impl_->stop_request); }

double ThreadTeam::others_cpu_seconds() const {
  double sum = 0;
  for (std::thread& thread : impl_->threads) {
    clockid_t clock = {};
    timespec time = {};
    if (pthread_getcpuclockid(thread.native_handle(), &clock) != 0 || clock_gettime(clock, &time) != 0) continue;
    sum += static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  return sum;
}

void ThreadTeam::Run(std::size_t count, std::size_t grain, LoopBody call, const void* body) {
  if (count == 0) return;
  ThrowIfStopped();
  Impl& impl = *impl_;
  const std::size_t parts = kPartsPerThread * static_cast<std::size_t>(impl.size);
  const std::size_t part = std::max({grain, std::size_t{1}, (count - 1) / parts + 1});
  if (part >= count) {
    call(body, 0, count);
    return;
  }
  if (impl.size == 1) {
    for (std::size_t begin = 0; begin < count; begin += part) {
      ThrowIfStopped();
      call(body, begin, std::min(begin + part, count));
    }
    return;
  }
  FASCICLE_CHECK(!impl.busy.exchange(true), "a team runs one loop at a time, and none inside another");
  impl.call = call;
  impl.body = body;
  impl.count = count;
  impl.part = part;
  impl.Open();
  impl.RunParts();
  impl.CloseAndWait();
  impl.busy.store(false);
  ThrowIfStopped();
}

double ThreadTeam::RunSum(std::size_t count, SumBody call, const void* body) {
  ThrowIfStopped();
  const std::size_t blocks = count == 0 ? 0 : (count - 1) / kSumBlock + 1;
  const auto term = [&](std::size_t block) {
    return call(body, block * kSumBlock, std::min((block + 1) * kSumBlock, count));
  };
  double sum = 0;
  if (impl_->size == 1) {
    for (std::size_t block = 0; block < blocks; ++block) sum += term(block);
    return sum;
  }
  std::vector<double>& terms = impl_->terms;
  if (terms.size() < blocks) terms.resize(blocks);
  For(blocks, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block) terms[block] = term(block);
  });
  for (std::size_t block = 0; block < blocks; ++block) sum += terms[block];
  return sum;
}

}  // namespace fascicle
