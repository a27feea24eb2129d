// The time from a stop request to the end of a run, for requests spread over its set-up and its first steps: a table,
// not a comparison.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <string>

#include "ratio.h"
#include "tests/support/brick_bodies.h"
#include "tests/support/isometric_muscle.h"
#include "tests/support/solids.h"

namespace fascicle::bench {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kMoments = 12;

class NoSink : public FrameSink {
 public:
  bool PutFrame(Frame, std::string) override { return true; }
  void PutProgress(const Progress&) override {}
};

// A ball in a grid of 64^3 cells, under gravity.
Scene Ball() {
  Body body;
  body.name = "ball";
  body.shape = SurfaceShape{testing::CubeSurface(0.1, 40, true), {}, {}, {}};
  body.material = NeoHookean(std::array{2e4, 0.3});
  Scene scene;
  scene.bodies = {body};
  scene.method = Method::kEulerian;
  scene.eulerian.cell_size = 0.22 / 64;
  scene.eulerian.margin = 0.6;
  scene.gravity.acceleration = Vec3(0, 0, -0.1);
  scene.duration = 10;
  scene.output.frame_interval = 10;
  return scene;
}

Scene VoxelBox() {
  Body body = testing::VoxelBox(Vec3::Constant(0.07), {70, 70, 70}, LinearElastic(std::array{5e6, 0.4}));
  body.constraints = {{0, {true, true, true}, {}}};
  body.loads = {{1, Traction{Vec3(0, 0, 100)}, Curve::Constant(1), {}}};
  return testing::VoxelScene(std::move(body));
}

Scene ManyTetrahedra() {
  Scene scene = testing::OneBody(testing::BoxBody(Vec3::Constant(0.1), {55, 55, 55}, NeoHookean(std::array{1e4, 0.3})));
  scene.gravity.acceleration = Vec3(0, 0, -1);
  scene.output.frame_interval = 1;
  return scene;
}

// Seconds from a request made after `delay` [s] to the end of the run; negative if it ended by itself before.
double SecondsToStop(const std::shared_ptr<const Scene>& scene, double delay) {
  std::stop_source stop;
  auto run = std::async(std::launch::async, [&] {
    NoSink sink;
    try {
      Simulation(scene, 2, nullptr, stop.get_token()).Run(sink, stop.get_token());
    } catch (const Stopped&) {
    }
    return Clock::now();
  });
  std::this_thread::sleep_for(std::chrono::duration<double>(delay));
  const Clock::time_point request = Clock::now();
  stop.request_stop();
  return std::chrono::duration<double>(run.get() - request).count();
}

void Print(const char* name, const Scene& scene, double last) {
  const auto shared = std::make_shared<const Scene>(scene);
  double longest = 0, sum = 0, at = 0;
  int ended = 0;
  for (int k = 0; k < kMoments; ++k) {
    const double delay = last * (k + 0.5) / kMoments, seconds = SecondsToStop(shared, delay);
    if (seconds < 0) ++ended;
    if (seconds > longest) {
      longest = seconds;
      at = delay;
    }
    sum += std::max(0.0, seconds);
  }
  std::printf(
      "%-48s longest %.3f s (requested after %.1f s), mean %.3f s, of %d requests over %.0f s; %d came too late\n",
      name, longest, at, sum / kMoments, kMoments, last, ended);
  std::fflush(stdout);
}

int Main() {
  Print("eulerian ball, 64^3 cells", Ball(), 8);
  Print("quasi-static muscle, 99,225 free components", testing::IsometricMuscle(testing::NearestMuscleGrid(100'000)),
        30);
  Print("voxel box, 343,000 voxels, static", VoxelBox(), 6);
  Print("explicit box, 998,250 tetrahedra", ManyTetrahedra(), 12);
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace fascicle::bench

int main() { return fascicle::bench::Main(); }
