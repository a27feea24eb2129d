// Speed of the tet method: force evaluations and whole steps on a box of 105,456 tetrahedra with the full muscle law.
// Comparisons with other programs are in tet_force_bench, tet_tangent_bench and tet_solve_bench.
#include <benchmark/benchmark.h>

#include <memory>

#include "tests/support/tet_box.h"
#include "tests/support/tet_stepper.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// Half activated, with strain damping for the mixed step.
Scene MuscleBox(Stepping stepping) {
  Scene scene = TetBox::MakeScene(26, Muscle(kMuscle), VolumeForm::kNodal);
  scene.bodies[0].damping.viscosity = stepping == Stepping::kMixed ? 20 : 0;
  scene.tet.stepping = stepping;
  return scene;
}

// Moderately deformed.
struct Box {
  Box(int threads, Stepping stepping) : scene(MuscleBox(stepping)), model(scene), team(threads), solver(model, team) {
    state = solver.InitialState();
    Mat3 F;
    F << 1.05, 0.04, 0, 0.02, 0.97, 0.03, 0, 0.01, 0.99;
    for (Vec3& x : state.positions) x = F * x;
  }

  void EvaluateForce() { ElasticForce(model, activation, state.positions, team, corners, state.force); }

  Scene scene;
  TetModel model;
  ThreadTeam team;
  TetStepper solver;
  TetState state;
  ForceWorkspace corners;
  std::array<double, 1> activation = {kActivation};
};

void CountElements(benchmark::State& state, const Box& box) {
  state.counters["Mtets/s"] = benchmark::Counter(1e-6 * static_cast<double>(state.iterations() * box.model.elements()),
                                                 benchmark::Counter::kIsRate);
}

void TetForce(benchmark::State& state) {
  Box box(static_cast<int>(state.range(0)), Stepping::kExplicit);
  for (auto _ : state) box.EvaluateForce();
  CountElements(state, box);
}
BENCHMARK(TetForce)
    ->Name("tet_force")
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void TetStep(benchmark::State& state) {
  const auto stepping = static_cast<Stepping>(state.range(0));
  Box box(static_cast<int>(state.range(1)), stepping);
  // Repeats the same step, so that the state does not change.
  const double next_time = 0.9 * box.solver.StableStepAt(box.state);
  TetState next;
  box.EvaluateForce();
  box.solver.Attempt(box.state, next_time, next);
  for (auto _ : state) {
    if (box.solver.Attempt(box.state, next_time, next).problem != StepProblem::kNone)
      state.SkipWithError("a step failed");
  }
  CountElements(state, box);
}
BENCHMARK(TetStep)
    ->Name("tet_step")
    ->ArgNames({"mixed", "threads"})
    ->Args({0, 1})
    ->Args({0, 2})
    ->Args({1, 1})
    ->Args({1, 2})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void StableStep(benchmark::State& state) {
  Box box(1, Stepping::kExplicit);
  for (auto _ : state) benchmark::DoNotOptimize(box.solver.StableStepAt(box.state));
  CountElements(state, box);
}
BENCHMARK(StableStep)->Name("tet_stable_step")->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fascicle

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
