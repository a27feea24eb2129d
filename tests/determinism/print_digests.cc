// For fresh_process_test.cc: print_digests direct|small THREADS prints `NAME DIGEST` lines.
//   direct  each kind of direct solve above 10,000 unknowns
//   small   each of the small scenes; the first line names the instruction set
#include <cstdio>
#include <cstdlib>

#include "core/base/digest.h"
#include "core/base/instruction_set.h"
#include "core/linalg/direct_solver.h"
#include "core/linalg/lanczos.h"
#include "core/linalg/lower_triangle.h"
#include "small_scenes.h"

namespace fascicle::testing {
namespace {

void Print(const char* name, std::string_view bytes) { std::printf("%s %s\n", name, Hex(Sha256Of(bytes)).c_str()); }

void SolveAndPrint(const char* name, std::int32_t size, const LowerTriangle& matrix) {
  DirectSolver solver;
  if (size <= 10'000 || !matrix.Factor(size, solver)) std::exit(1);
  std::vector<double> x(size);
  for (std::int32_t i = 0; i < size; ++i) x[i] = HashedUnit(i);
  solver.Solve(x);
  Print(name, {reinterpret_cast<const char*>(x.data()), x.size() * sizeof(double)});
}

// Springs of about 1 between neighbours of a grid of n^3 nodes, and one to the ground at each node.
void AddSprings(int n, LowerTriangle& matrix) {
  const std::int32_t strides[3] = {1, n, n * n};
  for (std::int32_t i = 0; i < n * n * n; ++i) {
    matrix.Add(i, i, 7);
    for (const std::int32_t stride : strides) {
      if (i / stride % n > 0) matrix.Add(i, i - stride, -1 + 0.1 * HashedUnit(i));
    }
  }
}

// Springs, and a relaxed constraint on the sum over each block of 2^3 nodes.
void SolveSaddle() {
  constexpr int kNodes = 22, kBlocks = kNodes / 2;
  LowerTriangle matrix;
  AddSprings(kNodes, matrix);
  std::int32_t row = kNodes * kNodes * kNodes;
  for (int block = 0; block < kBlocks * kBlocks * kBlocks; ++block, ++row) {
    const int corner =
        2 * (block % kBlocks + kNodes * (block / kBlocks % kBlocks + kNodes * (block / kBlocks / kBlocks)));
    for (int a = 0; a < 8; ++a) matrix.Add(row, corner + a % 2 + kNodes * (a / 2 % 2 + kNodes * (a / 4)), 1);
    matrix.Add(row, row, -1e-3);
  }
  SolveAndPrint("saddle", row, matrix);
}

void RunAndPrint(const char* name, const Scene& scene, int threads) {
  const RunResult run = RunScene(scene, threads);
  if (run.outcome.kind != Outcome::Kind::kSucceeded) std::exit(1);
  std::string digests;
  for (const Frame& frame : run.frames) digests += Hex(frame.digest);
  Print(name, digests);
}

// Dynamic and linear: factored once, 12,675 unknowns.
Scene DynamicVoxels() {
  Body body = VoxelBox(Vec3(0.05, 0.05, 0.1), {12, 12, 24}, LinearElastic(std::array{1e5, 0.3}));
  body.constraints = {{0, {true, true, true}, {}}};
  Scene scene = VoxelScene(std::move(body));
  scene.gravity.acceleration = Vec3(0, 1, -9.81);
  scene.voxel.stepping = VoxelStepping::kDynamic;
  scene.duration = 0.004;
  scene.output.frame_interval = 0.002;
  return scene;
}

// A muscle of quadratic elements, about 12,700 unknowns: a positive definite part for the nodes, and pressures with a
// negative sign.
// signs.
Scene QuasiStaticMuscle() {
  Body body = BoxBody(Vec3(0.02, 0.02, 0.06), {5, 5, 17}, Muscle(std::array{3e4, 1e4, 8e6, 3e5, 1.0, 0.05, 6.6, 1.4}));
  body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3::UnitZ());
  body.constraints = {Fix(kZ0), Fix(kZ1)};
  body.activation = Curve{{0, 1}, {0, 0.1}};
  Scene scene = OneBody(std::move(body));
  scene.output.frame_interval = 1;
  scene.tet.stepping = Stepping::kQuasiStatic;
  scene.tet.element = ElementOrder::kQuadratic;
  scene.tet.linear_solver = LinearSolver::kDirect;
  scene.tet.newton_tolerance = 1e-3;
  return scene;
}

void PrintDirectSolves(int threads) {
  constexpr int kNodes = 24;
  LowerTriangle definite;
  AddSprings(kNodes, definite);
  SolveAndPrint("definite", kNodes * kNodes * kNodes, definite);
  SolveSaddle();
  RunAndPrint("dynamic_voxels", DynamicVoxels(), threads);
  RunAndPrint("quasi_static_muscle", QuasiStaticMuscle(), threads);
}

void PrintSmallScenes(int threads) {
  std::printf("instruction set %d\n", static_cast<int>(PreferredInstructionSet()));
  for (const NamedScene& named : SmallScenes()) RunAndPrint(named.name.c_str(), named.scene, threads);
}

}  // namespace
}  // namespace fascicle::testing

int main(int, char** arguments) {
  const int threads = std::atoi(arguments[2]);
  if (std::string_view(arguments[1]) == "direct") {
    fascicle::testing::PrintDirectSolves(threads);
  } else {
    fascicle::testing::PrintSmallScenes(threads);
  }
}
