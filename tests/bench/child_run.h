#ifndef FASCICLE_TESTS_BENCH_CHILD_RUN_H_
#define FASCICLE_TESTS_BENCH_CHILD_RUN_H_

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <new>
#include <type_traits>

// Runs work in a process of its own, so that its CPU time and peak memory can be measured separately.
namespace fascicle::bench {

template <class Report>
struct ChildRun {
  enum class End { kFinished, kOutOfTime, kCrashed };
  End end = End::kCrashed;
  Report report;        // what the child has reported
  double cpu = 0;       // of the process, since its start [s]
  double peak_rss = 0;  // [bytes]
};

// Calls work(report), which fills in the report as it proceeds, and kills it after `limit` seconds of wall time (at
// least 1). Call only while the process has one thread.
template <class Report, class Work>
ChildRun<Report> RunInChild(unsigned limit, const Work& work) {
  static_assert(std::is_trivially_copyable_v<Report>);
  void* const shared =
      mmap(nullptr, sizeof(Report), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, /*fd=*/-1, /*offset=*/0);
  if (shared == MAP_FAILED) std::abort();
  Report& report = *new (shared) Report();
  const pid_t child = fork();
  if (child < 0) std::abort();
  if (child == 0) {
    alarm(limit);
    work(report);
    _exit(0);
  }
  int status = 0;
  rusage usage = {};
  if (wait4(child, &status, 0, &usage) != child) std::abort();
  ChildRun<Report> run;
  run.report = report;
  munmap(shared, sizeof(Report));
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) run.end = ChildRun<Report>::End::kFinished;
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) run.end = ChildRun<Report>::End::kOutOfTime;
  run.cpu = static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
            1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  run.peak_rss = 1024.0 * static_cast<double>(usage.ru_maxrss);
  return run;
}

}  // namespace fascicle::bench

#endif  // FASCICLE_TESTS_BENCH_CHILD_RUN_H_
