// The estimate of a run's memory beside what the run takes, each in a process of its own.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "core/sim/job_size.h"
#include "core/sim/simulation.h"
#include "tests/support/brick_bodies.h"
#include "tests/support/eulerian_scenes.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

class NoSink final : public FrameSink {
 public:
  bool PutFrame(Frame, std::string) override { return true; }
  void PutProgress(const Progress&) override {}
};

// Largest resident memory of a process that does something [byte].
double PeakOf(const std::function<void()>& action) {
  const pid_t child = fork();
  if (child == 0) {
    action();
    _exit(0);
  }
  int status = 0;
  rusage used = {};
  wait4(child, &status, 0, &used);
  EXPECT_EQ(status, 0);
  return 1024.0 * static_cast<double>(used.ru_maxrss);
}

Scene Cube(int side, Stepping stepping, ElementOrder element, LinearSolver solver = LinearSolver::kAutomatic) {
  Body body = BoxBody(Vec3::Constant(0.1), {side, side, side}, NeoHookean(std::array{1e4, 0.45}), CellsOf(element));
  body.constraints.push_back(Fix(kX0));
  Scene scene = OneBody(std::move(body));
  scene.tet.stepping = stepping;
  scene.tet.element = element;
  scene.tet.linear_solver = solver;
  scene.gravity = {Vec3(0, 0, -1), {{0, 1}, {0, 1}, Curve::Interpolation::kLinear}};
  scene.duration = scene.output.frame_interval = stepping == Stepping::kExplicit ? 1e-4 : 0.01;
  return scene;
}

void ExpectAbout(const char* name, const Scene& scene) {
  const double base = PeakOf([] {});
  const double taken = PeakOf([&] {
    NoSink sink;
    Simulation(std::make_shared<Scene>(scene), 1).Run(sink, {}, std::chrono::seconds(100));
  });
  const double estimate = JobSizeOf(scene).memory;
  std::printf("%-28s estimate %7.1f MB, taken %7.1f MB\n", name, estimate * 1e-6, (taken - base) * 1e-6);
  EXPECT_GT(estimate, 0.5 * (taken - base)) << name;
  EXPECT_LT(estimate, 2.5 * (taken - base)) << name;
}

TEST(JobSizeTest, MemoryIsAboutThatOfTheRun) {
#ifdef FASCICLE_SANITIZED
  GTEST_SKIP() << "sanitizers take memory for themselves";
#endif
  ExpectAbout("explicit, linear", Cube(36, Stepping::kExplicit, ElementOrder::kLinear));
  ExpectAbout("explicit, quadratic", Cube(24, Stepping::kExplicit, ElementOrder::kQuadratic));
  ExpectAbout("quasi-static, linear", Cube(24, Stepping::kQuasiStatic, ElementOrder::kLinear));
  ExpectAbout("quasi-static, quadratic", Cube(14, Stepping::kQuasiStatic, ElementOrder::kQuadratic));
  ExpectAbout("quasi-static, hexahedra", Cube(20, Stepping::kQuasiStatic, ElementOrder::kHexahedral));
  ExpectAbout("direct, quadratic", Cube(8, Stepping::kQuasiStatic, ElementOrder::kQuadratic, LinearSolver::kDirect));
  Scene voxels = VoxelScene(VoxelBox(Vec3::Constant(0.04), {48, 48, 48}, LinearElastic(std::array{1e4, 0.3})));
  ExpectAbout("voxels", voxels);
}

TEST(JobSizeTest, StoredBytesAreThoseOfTheFrames) {
  Scene scene = Cube(2, Stepping::kExplicit, ElementOrder::kLinear);
  scene.duration = 10 * scene.output.frame_interval;
  EXPECT_EQ(JobSizeOf(scene).stored, 11 * 27 * 24.0);
  scene.output.fields = {OutputField::kVelocity};
  EXPECT_EQ(JobSizeOf(scene).stored, 11 * 2 * 27 * 24.0);
}

}  // namespace
}  // namespace fascicle
