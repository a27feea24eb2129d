// A quasi-static muscle (reference problem d, activation 0 to 0.3) of increasing size: one table of time, iterations,
// memory and their growth beside FEBio 4.11's figures for the same grids; or another problem of about the same sizes.
// Each size runs in a process of its own. A tool for development; tet_solve_bench measures the rows
// tet_quasistatic_vs_newton_cholmod and tet_quasistatic_threads_2.
#include <getopt.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "child_run.h"
#include "ratio.h"
#include "tests/support/isometric_muscle.h"

namespace fascicle::bench {
namespace {

using namespace fascicle::testing;

constexpr double kActivation = 0.3;
// FEBio's ten-node elements with straight edges (6 x 6 x 20); its finest mesh of hexahedra gives 25.338 N.
constexpr double kReferenceForce = 25.499;  // [N]

// FEBio 4.11, three steps, measured earlier on a comparable machine.
struct ReferenceRun {
  int components;
  int iterations;
  double cpu;   // [s]
  double peak;  // [GB]
};
constexpr ReferenceRun kReferenceRuns[] = {{9477, 12, 2.4, 0.1}, {47685, 12, 35, 0.6}, {99225, 12, 106, 1.4}};

struct Problem {
  const char* name;
  const char* what;
  Scene (*scene)(const MuscleGrid& grid);
  double end;  // its loads rise until then [s]
};
constexpr Problem kProblems[] = {
    {"d", "isometric muscle, activation 0 to 0.3, curved edges", IsometricMuscle, kActivation},
    {"bent", "bent isometric muscle, activation 0 to 0.3, curved edges", BentMuscle, kActivation},
    {"ring", "ring of muscle, activation 0 to 0.3, curved edges", MuscleRing, kActivation},
    {"block", "block of rubber stretched by half", StretchedBlock, 1},
};

struct Options {
  const Problem* problem = &kProblems[0];
  std::vector<double> sizes = {10e3, 50e3, 100e3};
  int steps = 1;
  int threads = 1;
  double tolerance = 0;  // 0: the scene's default
  unsigned limit = 300;  // [s]
};

struct Report {
  double scene = 0;  // mesh, fibres and regions [s]
  double setup = 0;  // model and solver [s]
  int components = 0, elements = 0;
  double wall = 0;  // of all, mesh included [s]
  long long iterations = 0;
  int steps = 0;
  double force = 0;  // [N]
  bool failed = false;
};

void RunMuscle(const MuscleGrid& grid, const Options& options, Report& report) {
  const auto start = std::chrono::steady_clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  Scene scene = options.problem->scene(grid);
  if (options.tolerance > 0) scene.tet.newton_tolerance = options.tolerance;
  const double before_model = report.scene = passed();
  const TetModel model(scene);
  ThreadTeam team(options.threads);
  TetStepper solver(model, team);
  TetState state = solver.InitialState();
  report.setup = passed() - before_model;
  report.elements = static_cast<int>(model.elements());
  for (const Vec3& m : model.inverse_mass()) report.components += static_cast<int>((m.array() != 0).count());
  for (int step = 1; step <= options.steps && !report.failed; ++step) {
    const double end = options.problem->end * step / options.steps;
    while (state.time < end && !report.failed) {
      report.failed = solver.Advance(state, end).problem != StepProblem::kNone;
      report.iterations = state.iterations;
      report.wall = passed();
      ++report.steps;
    }
  }
  report.force = solver.Reactions(state).at(1).norm();
  report.wall = passed();
}

const ReferenceRun* ReferenceOf(const MuscleGrid& grid) {
  for (const ReferenceRun& run : kReferenceRuns) {
    if (run.components == grid.FreeComponents()) return &run;
  }
  return nullptr;
}

void PrintReference(const MuscleGrid& grid, const ChildRun<Report>& run) {
  const ReferenceRun* const reference = ReferenceOf(grid);
  if (reference == nullptr) return;
  std::printf("%10s %8s %5d %6d %8s %8s %8s %8.1f %8.0f", "reference", "", 3, reference->iterations, "", "", "",
              reference->cpu, 1e3 * reference->peak);
  if (run.end == ChildRun<Report>::End::kFinished && !run.report.failed) {
    std::printf("   %.1f times the time, %.1f times the memory", reference->cpu / run.cpu,
                1e9 * reference->peak / run.peak_rss);
  }
  std::printf("\n");
}

// A measured size; no components if it has no time to compare with.
struct Row {
  int components = 0;
  double cpu = 0;  // [s]
};

double GrowthFrom(const Row& before, const Row& now) {
  return std::log(now.cpu / before.cpu) / std::log(static_cast<double>(now.components) / before.components);
}

Row MeasureRow(const MuscleGrid& grid, const Options& options, const Row& before) {
  const auto run = RunInChild<Report>(options.limit, [&](Report& report) { RunMuscle(grid, options, report); });
  const Report& report = run.report;
  std::printf("%10d %8d %5d %6lld %8.2f %8.2f %8.2f %8.2f %8.0f", report.components, report.elements, report.steps,
              report.iterations, report.scene, report.setup, report.wall, run.cpu, 1e-6 * run.peak_rss);
  const bool good = run.end == ChildRun<Report>::End::kFinished && !report.failed;
  const Row row{report.components, run.cpu};
  if (good) {
    if (before.components > 0) {
      std::printf(" %7.2f", GrowthFrom(before, row));
    } else {
      std::printf(" %7s", "");
    }
    std::printf(" %9.4f", report.force);
    if (options.problem == &kProblems[0]) std::printf(" (%+.2f %%)", 100 * (report.force / kReferenceForce - 1));
    std::printf("\n");
  } else if (run.end == ChildRun<Report>::End::kOutOfTime) {
    std::printf(" not done after %u s\n", options.limit);
  } else {
    std::printf(run.end == ChildRun<Report>::End::kCrashed ? " crashed\n" : " did not converge\n");
  }
  if (options.problem == &kProblems[0]) PrintReference(grid, run);
  std::fflush(stdout);
  return good ? row : Row{};
}

void MeasureAll(const Options& options) {
  std::printf("%s, ten-node elements, %d thread(s)\n", options.problem->what, options.threads);
  std::printf("%10s %8s %5s %6s %8s %8s %8s %8s %8s %7s %9s\n", "free", "elements", "steps", "Newton", "scene s",
              "set-up s", "wall s", "CPU s", "peak MB", "growth", "force N");
  const CpuTime before = CpuTime::Now();
  Row first, last;
  const double wall = SecondsOf([&] {
    for (const double size : options.sizes) {
      const Row row = MeasureRow(NearestMuscleGrid(size), options, last);
      if (row.components == 0) continue;
      last = row;
      if (first.components == 0) first = row;
    }
  });
  const CpuTime after = CpuTime::Now();
  if (last.components > first.components) {
    std::printf("growth of CPU time with free components, %d to %d: n^%.2f\n", first.components, last.components,
                GrowthFrom(first, last));
  }
  const double others = (after.machine - before.machine) - (after.own - before.own);
  const double share = others / (wall * static_cast<double>(sysconf(_SC_NPROCESSORS_ONLN)));
  if (share > 0.05) std::printf("warning: other processes took %.0f %% of the machine meanwhile\n", 100 * share);
}

[[noreturn]] void Usage() {
  std::fprintf(
      stderr,
      "quasistatic_bench [--problem d|bent|ring|block] [--sizes 10000,50000,100000] [--steps 1] [--threads 1]\n"
      "                  [--tolerance 1e-8] [--limit SECONDS]\n"
      "  sizes in free components of the displacement; the nearest grid is run. limit: wall time of one size.\n");
  std::exit(2);
}

double NumberOf(const char* text, double least) {
  char* end = nullptr;
  const double value = std::strtod(text, &end);
  if (end == text || *end != '\0' || !(value >= least)) Usage();
  return value;
}

std::vector<double> NumbersOf(std::string text) {
  std::vector<double> numbers;
  for (char* part = std::strtok(text.data(), ","); part != nullptr; part = std::strtok(nullptr, ",")) {
    numbers.push_back(NumberOf(part, 1));
  }
  if (numbers.empty()) Usage();
  return numbers;
}

Options Parse(int argc, char** argv) {
  constexpr option kOptions[] = {{"problem", required_argument, nullptr, 'p'},
                                 {"sizes", required_argument, nullptr, 's'},
                                 {"steps", required_argument, nullptr, 'n'},
                                 {"threads", required_argument, nullptr, 't'},
                                 {"tolerance", required_argument, nullptr, 'e'},
                                 {"limit", required_argument, nullptr, 'l'},
                                 {nullptr, 0, nullptr, 0}};
  Options options;
  for (int key = 0; (key = getopt_long(argc, argv, "", kOptions, nullptr)) != -1;) {
    switch (key) {
      case 'p':
        options.problem = std::find_if(std::begin(kProblems), std::end(kProblems),
                                       [](const Problem& problem) { return std::string(problem.name) == optarg; });
        if (options.problem == std::end(kProblems)) Usage();
        break;
      case 's':
        options.sizes = NumbersOf(optarg);
        break;
      case 'n':
        options.steps = static_cast<int>(NumberOf(optarg, 1));
        break;
      case 't':
        options.threads = static_cast<int>(NumberOf(optarg, 1));
        break;
      case 'e':
        options.tolerance = NumberOf(optarg, 0);
        break;
      case 'l':
        options.limit = static_cast<unsigned>(NumberOf(optarg, 1));
        break;
      default:
        Usage();
    }
  }
  if (optind != argc) Usage();
  return options;
}

}  // namespace
}  // namespace fascicle::bench

int main(int argc, char** argv) { fascicle::bench::MeasureAll(fascicle::bench::Parse(argc, argv)); }
