#ifndef FASCICLE_TESTS_BENCH_RATIO_H_
#define FASCICLE_TESTS_BENCH_RATIO_H_

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

// Comparisons within one run: A and B alternate, and only the ratio of their times within a round counts, because
// absolute times depend on the load of the machine.
namespace fascicle::bench {

// CPU time of the whole machine and of this process (including children it has waited for) since their start [s].
struct CpuTime {
  double machine = 0;  // busy, all cores
  double own = 0;

  static CpuTime Now() {
    CpuTime now;
    std::ifstream stat("/proc/stat");
    std::string label;
    double user = 0, nice = 0, system = 0, idle = 0, iowait = 0, irq = 0, softirq = 0, steal = 0;
    stat >> label >> user >> nice >> system >> idle >> iowait >> irq >> softirq >> steal;
    now.machine = (user + nice + system + irq + softirq + steal) / static_cast<double>(sysconf(_SC_CLK_TCK));
    for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
      rusage usage = {};
      getrusage(who, &usage);
      now.own += static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                 1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    }
    return now;
  }
};

inline double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

template <class Function>
double SecondsOf(const Function& function) {
  const auto start = std::chrono::steady_clock::now();
  function();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Wall time, and CPU time of all threads of this process [s].
struct Duration {
  double wall = 0;
  double cpu = 0;
};

template <class Function>
Duration DurationOf(const Function& function) {
  const auto cpu_now = [] {
    timespec now = {};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  };
  const double cpu = cpu_now();
  const double wall = SecondsOf(function);
  return {wall, cpu_now() - cpu};
}

// The amount of work of one call of A or B: 0.105456 "Mtets" is printed as Mtets/s of each.
struct Amount {
  double count = 0;
  const char* unit = "";
};

// Rounds of a comparison; fewer only if one takes minutes.
inline constexpr int kRounds = 9;

// Runs A and B alternately and prints the medians of their times and the line
//
//   ratio NAME VALUE
//
// with the median over the rounds of time(B) / time(A): how many times faster A is. If other processes took more than 5
// % of the machine meanwhile, it also prints a warning and the ratio of CPU times, which is more reliable for
// single-threaded programs. Both must do the same amount of work. Each runs once before the first round to warm up
// caches and memory, unless a round takes minutes and there are fewer than kRounds.
//   rounds  the order of A and B alternates from round to round
template <class FunctionA, class FunctionB>
double MedianRatio(const std::string& name, int rounds, const FunctionA& a, const FunctionB& b,
                   const Amount& amount = {}) {
  if (rounds >= kRounds) {
    a();
    b();
  }
  std::vector<double> times_a, times_b, ratios, cpu_ratios;
  const CpuTime cpu_before = CpuTime::Now();
  const double wall = SecondsOf([&] {
    for (int round = 0; round < rounds; ++round) {
      Duration time_a, time_b;
      if (round % 2 == 0) {
        time_a = DurationOf(a);
        time_b = DurationOf(b);
      } else {
        time_b = DurationOf(b);
        time_a = DurationOf(a);
      }
      times_a.push_back(time_a.wall);
      times_b.push_back(time_b.wall);
      ratios.push_back(time_b.wall / time_a.wall);
      cpu_ratios.push_back(time_b.cpu / time_a.cpu);
    }
  });
  const CpuTime cpu_after = CpuTime::Now();
  const double others = (cpu_after.machine - cpu_before.machine) - (cpu_after.own - cpu_before.own);
  const double share = others / (wall * static_cast<double>(sysconf(_SC_NPROCESSORS_ONLN)));
  const double ratio = Median(ratios);
  std::printf("%s: A %.6g s, B %.6g s (medians of %zu rounds), ratios %.3f to %.3f\n", name.c_str(), Median(times_a),
              Median(times_b), ratios.size(), *std::min_element(ratios.begin(), ratios.end()),
              *std::max_element(ratios.begin(), ratios.end()));
  if (amount.count > 0) {
    std::printf("%s: A %.4g %s/s, B %.4g %s/s\n", name.c_str(), amount.count / Median(times_a), amount.unit,
                amount.count / Median(times_b), amount.unit);
  }
  if (share > 0.05) {
    std::printf("warning: other processes took %.0f %% of the machine meanwhile; by CPU time the ratio is %.3f\n",
                100 * share, Median(cpu_ratios));
  }
  std::printf("ratio %s %.3f\n", name.c_str(), ratio);
  std::fflush(stdout);
  return ratio;
}

}  // namespace fascicle::bench

#endif  // FASCICLE_TESTS_BENCH_RATIO_H_
