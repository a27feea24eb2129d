#ifndef FASCICLE_CORE_BASE_PARALLEL_H_
#define FASCICLE_CORE_BASE_PARALLEL_H_

#include <cstddef>
#include <memory>
#include <stop_token>
#include <type_traits>

#include "core/base/stop.h"

namespace fascicle {

// A fixed set of threads that run loops together with the calling thread.
// One loop at a time: member functions must not be called from two threads at once, nor from inside a loop.
//
// Loops are where work is interrupted: after a stop request, For and Sum throw Stopped in the calling thread, before
// the loop or after skipping parts of it. So work in loops stops within the time of one part of a loop.
class ThreadTeam {
 public:
  // threads >= 1.
  explicit ThreadTeam(int threads, std::stop_token stop = {});
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  int size() const;
  // Sets the token whose stop requests are observed from now on.
  void HeedStop(std::stop_token stop);
  // For long work between loops: throws Stopped after a stop request.
  void ThrowIfStopped() const;
  // For long work that does not use the team.
  const std::stop_token& stop() const;
  // Processor time of all threads but the calling one since the team was created [s].
  double others_cpu_seconds() const;

  // Calls body(begin, end) on disjoint ranges that cover [0, count), each at least `grain` long where possible. `body`
  // may write only what belongs to its own indices; the result then does not depend on the number of threads. `body`
  // must not throw. Allocates nothing. Throws Stopped after a stop request.
  template <class Body>
  void For(std::size_t count, std::size_t grain, const Body& body) {
    static_assert(std::is_invocable_v<const Body&, std::size_t, std::size_t>);
    Run(
        count, grain,
        [](const void* b, std::size_t begin, std::size_t end) { (*static_cast<const Body*>(b))(begin, end); }, &body);
  }

  // Sum of body(begin, end) over blocks of fixed size, added in the order of the blocks: the same bits for any number
  // of threads. Throws Stopped after a stop request.
  template <class Body>
  double Sum(std::size_t count, const Body& body) {
    static_assert(std::is_invocable_r_v<double, const Body&, std::size_t, std::size_t>);
    return RunSum(
        count,
        [](const void* b, std::size_t begin, std::size_t end) { return (*static_cast<const Body*>(b))(begin, end); },
        &body);
  }

 private:
  using LoopBody = void (*)(const void* body, std::size_t begin, std::size_t end);
  using SumBody = double (*)(const void* body, std::size_t begin, std::size_t end);
  void Run(std::size_t count, std::size_t grain, LoopBody call, const void* body);
  double RunSum(std::size_t count, SumBody call, const void* body);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Calls each(i) for all i in [0, count) as team.For does, and checks for a stop request before each call: for long work
// on few items.
template <class Each>
void ForEach(ThreadTeam& team, std::size_t count, std::size_t grain, const Each& each) {
  const std::stop_token& stop = team.stop();
  team.For(count, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && !stop.stop_requested(); ++i) each(i);
  });
  team.ThrowIfStopped();
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_PARALLEL_H_
