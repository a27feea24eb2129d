// Implicit and quasi-static steps compared with CHOLMOD, one thread, and two threads with one. Each comparison first
// checks that both sides have the same result, then prints both figures and `ratio NAME VALUE`.
//   tet_solve_bench [PART] [ROUNDS]    only the rows whose name contains PART; ROUNDS of each muscle
#include <cstdlib>
#include <string>

#include "plain_newton.h"
#include "ratio.h"
#include "tests/support/isometric_muscle.h"
#include "tests/support/tet_box.h"

namespace fascicle::bench {
namespace {

using namespace fascicle::testing;

constexpr double kMuscleActivation = 0.3;

void CheckAgreement(const std::string& row, const char* what, double difference, double tolerance) {
  std::printf("%s: %s agree to %.2g\n", row.c_str(), what, difference);
  if (difference <= tolerance) return;
  std::fprintf(stderr, "%s: they must agree to %.0e\n", row.c_str(), tolerance);
  std::exit(1);
}

// The largest difference of displacements relative to the largest displacement [1].
double Difference(const NodalVector& a, const NodalVector& b, const NodalVector& from) {
  double difference = 0, largest = 0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    difference = std::max(difference, (a[n] - b[n]).norm());
    largest = std::max(largest, (b[n] - from[n]).norm());
  }
  return difference / largest;
}

// CHOLMOD solves for the first Newton step of the same time step that the core makes.
void CompareImplicit(const std::string& row) {
  const Scene scene = FallingBox(21);  // 55,566 tetrahedra, 30,492 free components
  const double dt = *scene.tet.time_step;
  const TetModel model(scene);
  ThreadTeam team(1);
  TetStepper solver(model, team);
  TetState now = solver.InitialState(), next;
  for (int i = 1; i <= 3; ++i) solver.Advance(now, i * dt);
  const auto step = [&] {
    if (solver.Attempt(now, now.time + dt, next).problem != StepProblem::kNone) std::abort();
  };
  step();

  CondensedMatrix matrix(model);
  CholmodSolver cholmod(matrix);
  matrix.Assemble(std::array{0.0}, now.positions, {.inertia = 1 / (dt * dt)}, team);
  ForceWorkspace workspace;
  NodalVector force;
  ElasticForce(model, std::array{0.0}, now.positions, team, workspace, force);
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    force[n] += model.mass()[n] * (scene.gravity.acceleration + now.velocities[n] / dt);
  }
  const std::vector<double> right_side = matrix.ToComponents(force);
  std::vector<double> move;
  const auto factor_and_solve = [&] {
    if (!cholmod.Factor()) std::abort();
    move = cholmod.Solve(right_side);
  };
  factor_and_solve();
  NodalVector moved = now.positions;
  matrix.AddComponents(move, 1, moved);
  std::printf("%s: %d free components, %lld Newton iterations; L of CHOLMOD has %.3g entries\n", row.c_str(),
              matrix.size(), static_cast<long long>(next.iterations - now.iterations), cholmod.entries());
  CheckAgreement(row, "the step and its first Newton step", Difference(moved, next.positions, now.positions), 0.05);
  MedianRatio(row, kRounds, step, factor_and_solve);
}

struct MuscleRun {
  NodalVector positions;
  long long iterations = 0;
};

MuscleRun RunCore(const Scene& scene, int threads = 1) {
  testing::SteppedRun run(scene, threads);
  if (!run.To(kMuscleActivation)) std::abort();
  return {run.state.positions, run.state.iterations};
}

// Both sides include model, sparsity pattern, analysis and steps.
void CompareMuscle(const std::string& row, const MuscleGrid& grid, int rounds) {
  const Scene scene = IsometricMuscle(grid);
  MuscleRun ours;
  NodalVector theirs;
  int iterations = 0, factorizations = 0;
  double entries = 0;
  const auto run_core = [&] { ours = RunCore(scene); };
  const auto run_plain = [&] {
    const TetModel model(scene);
    PlainNewton plain(model);
    if (!plain.Run(0, kMuscleActivation, /*steps=*/1, scene.tet.newton_tolerance)) std::abort();
    theirs = plain.positions();
    iterations = plain.iterations();
    factorizations = plain.factorizations();
    entries = plain.solver().entries();
  };
  std::printf("%s: %d free components\n", row.c_str(), grid.FreeComponents());
  MedianRatio(row, rounds, run_core, run_plain);
  std::printf("%s: A %lld Newton iterations; B %d, %d factorizations, L of %.3g entries\n", row.c_str(),
              ours.iterations, iterations, factorizations, entries);
  CheckAgreement(row, "displacements", Difference(ours.positions, theirs, TetModel(scene).rest_positions()), 1e-5);
}

// The whole solution with two threads and with one: A is the former.
void CompareThreads(const std::string& row, const MuscleGrid& grid, int rounds) {
  const Scene scene = IsometricMuscle(grid);
  MuscleRun of_two, of_one;
  MedianRatio(
      row, rounds, [&] { of_two = RunCore(scene, 2); }, [&] { of_one = RunCore(scene, 1); });
  CheckAgreement(row, "positions", of_two.positions == of_one.positions ? 0 : 1, 0);
}

void MeasureGrowth() {
  const MuscleGrid small = NearestMuscleGrid(10e3), large = NearestMuscleGrid(100e3);
  const Scene small_scene = IsometricMuscle(small), large_scene = IsometricMuscle(large);
  const double small_time = SecondsOf([&] { RunCore(small_scene); });
  const double large_time = SecondsOf([&] { RunCore(large_scene); });
  std::printf("tet_quasistatic_growth: %.3g s at %d, %.3g s at %d free components: n^%.2f\n", small_time,
              small.FreeComponents(), large_time, large.FreeComponents(),
              std::log(large_time / small_time) /
                  std::log(static_cast<double>(large.FreeComponents()) / small.FreeComponents()));
}

// rounds: 0 for the default.
void CompareAll(const std::string& wanted, int rounds) {
  const auto run = [&](const std::string& row, const auto& compare) {
    if (row.find(wanted) != std::string::npos) compare(row);
  };
  run("tet_implicit_vs_cholmod", CompareImplicit);
  run("tet_quasistatic_vs_newton_cholmod_10k",
      [&](const std::string& row) { CompareMuscle(row, NearestMuscleGrid(10e3), rounds > 0 ? rounds : kRounds); });
  run("tet_quasistatic_threads_2",
      [&](const std::string& row) { CompareThreads(row, NearestMuscleGrid(100e3), rounds > 0 ? rounds : 3); });
  run("tet_quasistatic_growth", [](const std::string&) { MeasureGrowth(); });
  run("tet_quasistatic_vs_newton_cholmod",
      [&](const std::string& row) { CompareMuscle(row, NearestMuscleGrid(100e3), rounds > 0 ? rounds : 3); });
}

}  // namespace
}  // namespace fascicle::bench

int main(int argc, char** argv) {
  fascicle::bench::CompareAll(argc > 1 ? argv[1] : "", argc > 2 ? std::atoi(argv[2]) : 0);
}
