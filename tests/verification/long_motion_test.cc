// Undamped motion over many steps of Newmark's method (ten thousand in the slow program): releases and impacts of
// rubbers and muscles keep the energy of their start.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "tests/support/released_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

const MooneyRivlin kRubber(std::array{3e4, 1e4, 8e6});  // K/mu = 100
const Muscle kMuscle(std::array{1e4, 5e3, 2e6, 1e5, 1.1, 0.05, 6.6, 1.4});

Scene MotionScene(Body body, ElementOrder element = ElementOrder::kQuadratic) {
  body.density = 1060;
  body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3::UnitX());
  Scene scene = OneBody(std::move(body));
  scene.tet.element = element;
  return scene;
}

// A bar along x, clamped at one end and loaded on the other with a traction [Pa].
Scene LoadedBar(const Material& law, const Vec3& traction, ElementOrder element = ElementOrder::kQuadratic) {
  Body bar = BoxBody(Vec3(0.04, 0.01, 0.01), {4, 1, 1}, law, CellsOf(element));
  bar.constraints = {Fix(kX0)};
  bar.loads.push_back({kX1, Traction{traction}, Ramp(1), {}});
  return MotionScene(std::move(bar), element);
}

// A body that flies at the ground under gravity.
Scene Thrown(Body body, double height) {
  for (Vec3& X : body.tet().mesh.nodes) X[2] += height;
  Scene scene = MotionScene(std::move(body));
  scene.gravity.acceleration = Vec3(0, 0, -9.81);
  scene.floors = {{"ground", Vec3::Zero(), Vec3::UnitZ()}};
  scene.tet.stepping = Stepping::kNewmark;
  scene.duration = 1000;
  return scene;
}

double EnergyOf(SteppedRun& run) {
  double sum = KineticEnergy(run.model, run.state.velocities, run.team) + FloorEnergy(run.model, run.state.positions);
  const std::vector<double> activations = ControlSource(run.scene).At(run.state.time).activations;
  return sum + ElasticEnergy(run.model, 0, FibreDrive{activations}, run.state.positions, run.team) -
         run.state.external_work;
}

// Largest change of the energy over `steps` steps, relative to `scale` [J]. Fails if a step fails.
double Drift(SteppedRun& run, int steps, double scale) {
  const double start = EnergyOf(run);
  double drift = 0;
  while (run.state.step < steps) {
    const StepReport report = run.solver.Advance(run.state, 1000);
    EXPECT_EQ(report.problem, StepProblem::kNone) << "step " << run.state.step;
    if (report.problem != StepProblem::kNone) return INFINITY;
    if (run.state.step % 20 == 0) drift = std::max(drift, std::abs(EnergyOf(run) - start) / scale);
  }
  return drift;
}

struct Release {
  const char* name;
  double time_step;  // [s]
  std::function<Scene()> scene;
};

std::vector<Release> Releases() {
  return {
      {"rubber cantilever", 1e-3, [] { return LoadedBar(kRubber, Vec3(0, 0, -600)); }},
      {"compressible cantilever", 1e-3,
       [] {
         return LoadedBar(NeoHookean(std::array{2e5, 0.3}), Vec3(0, 0, -600));
       }},
      {"stretched rubber", 5e-4, [] { return LoadedBar(kRubber, Vec3(3e4, 0, 0)); }},
      {"skew pull on rubber", 1e-3,
       [] {
         return LoadedBar(Ogden(std::array{4e4, 1.3, 3e3, 5.0, 2e4, -2.0, 4e6}), Vec3(5e3, 2e3, -2e3));
       }},
      {"hexahedra", 1e-3, [] { return LoadedBar(kRubber, Vec3(0, 0, -600), ElementOrder::kHexahedral); }},
      {"linear elements", 1e-3, [] { return LoadedBar(kRubber, Vec3(0, 0, -600), ElementOrder::kLinear); }},
      {"passive muscle", 1e-3, [] { return LoadedBar(kMuscle, Vec3(1e4, 0, -500)); }},
      {"active muscle", 1e-3,
       [] {
         Scene scene = LoadedBar(kMuscle, Vec3(1e4, 0, -500));
         scene.bodies[0].activation = Curve{{0}, {0.3}};
         return scene;
       }},
  };
}

std::vector<Release> Impacts() {
  return {
      {"rubber cube", 5e-4,
       [] {
         return Thrown(BoxBody(Vec3(0.02, 0.02, 0.02), {2, 2, 2}, NeoHookean(std::array{2e4, 0.3})), 0.005);
       }},
      {"bar on its edge", 5e-4,
       [] {
         Body bar = BoxBody(Vec3(0.04, 0.01, 0.01), {4, 1, 1}, kRubber);
         const Mat3 turn = Eigen::AngleAxisd(0.5, Vec3(1, 2, 0).normalized()).toRotationMatrix();
         for (Vec3& X : bar.tet().mesh.nodes) X = turn * X + Vec3(0, 0, 0.02);
         return Thrown(std::move(bar), 0.02);
       }},
      {"ring", 5e-4,
       [] {
         TetMesh ring =
             MakeTorus({.major_radius = 0.02, .minor_radius = 0.005, .divisions_around = 10, .divisions_across = 1});
         for (Vec3& X : ring.nodes) X = Vec3(X[0], X[2], X[1] + 0.03);
         for (Tetrahedron& tet : ring.tetrahedra) std::swap(tet[2], tet[3]);
         return Thrown(MakeBody("ring", std::move(ring), kRubber), 0.005);
       }},
      {"active muscle", 5e-4,
       [] {
         Body muscle = BoxBody(Vec3(0.04, 0.01, 0.01), {4, 1, 1}, kMuscle);
         muscle.activation = Curve{{0}, {0.2}};
         return Thrown(std::move(muscle), 0.01);
       }},
  };
}

void CheckRelease(const Release& release, int steps) {
  ReleasedRun run(release.scene(), Stepping::kNewmark, release.time_step);
  ASSERT_TRUE(run.is_in_equilibrium) << release.name;
  // What the release sets free: the energy beyond that of rest.
  SteppedRun rest(release.scene());
  const double scale = std::abs(run.Energy() - EnergyOf(rest));
  const double drift = Drift(run, steps, scale);
  std::printf("%-24s %6d steps, drift of the energy %.2g\n", release.name, steps, drift);
  EXPECT_LT(drift, 1e-3) << release.name;
}

void CheckImpact(const Release& impact, int steps) {
  Scene scene = impact.scene();
  scene.tet.time_step = impact.time_step;
  SteppedRun run(scene);
  for (Vec3& v : run.state.velocities) v = Vec3(0.1, 0, -1);
  const double scale = KineticEnergy(run.model, run.state.velocities, run.team);
  const double drift = Drift(run, steps, scale);
  std::printf("%-24s %6d steps, drift of the energy %.2g\n", impact.name, steps, drift);
  EXPECT_LT(drift, 1e-3) << impact.name;
}

#ifdef FASCICLE_LONG_MOTION
constexpr int kSteps = 10000;
#else
constexpr int kSteps = 60;
#endif

TEST(LongMotionTest, ReleasesKeepTheirEnergy) {
  for (const Release& release : Releases()) CheckRelease(release, kSteps);
}

TEST(LongMotionTest, ImpactsKeepTheirEnergy) {
  for (const Release& impact : Impacts()) CheckImpact(impact, kSteps);
}

}  // namespace
}  // namespace fascicle
