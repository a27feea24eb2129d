// Implicit steps: order of convergence, conservation, rest, cancelling.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

// A free box that vibrates after a push along its long axis, in steps of a fixed length.
Scene RingingBox(Stepping stepping, ElementOrder element, const Material& law, double time_step) {
  Scene scene = OneBody(BoxBody(Vec3(0.04, 0.02, 0.02), {2, 1, 1}, law));
  scene.tet.stepping = stepping;
  scene.tet.element = element;
  scene.tet.time_step = time_step;
  return scene;
}

void Push(SteppedRun& run) {
  for (std::size_t n = 0; n < run.model.nodes(); ++n) {
    const Vec3& X = run.model.rest_positions()[n];
    run.state.velocities[n] = Vec3(0.5, 0.1, 0) + 8 * Vec3(X[0] - 0.02, 0.5 * (X[0] - 0.02), 0.01 - X[2]);
  }
}

// About a period of the slowest mode of the box.
constexpr double kPeriod = 0.03;  // [s]

NodalVector PositionsAfterSteps(Stepping stepping, ElementOrder element, int steps) {
  const double duration = kPeriod / 3;
  SteppedRun run(RingingBox(stepping, element, CorotatedLinear(std::array{1e4, 0.3}), duration / steps));
  Push(run);
  EXPECT_TRUE(run.To(duration));
  EXPECT_EQ(run.state.step, steps);
  return run.state.positions;
}

class ImplicitTest : public ::testing::TestWithParam<std::tuple<Stepping, ElementOrder>> {
 protected:
  static Stepping SteppingOf() { return std::get<0>(GetParam()); }
  static ElementOrder Element() { return std::get<1>(GetParam()); }
};

std::string NameOf(const ::testing::TestParamInfo<std::tuple<Stepping, ElementOrder>>& info) {
  const auto& [stepping, element] = info.param;
  const std::string scheme = stepping == Stepping::kBackwardEuler ? "BackwardEuler"
                             : stepping == Stepping::kNewmark     ? "Newmark"
                                                                  : "Bdf2";
  return scheme + (element == ElementOrder::kLinear ? "Linear" : "Quadratic");
}

// Halving the step halves the error of backward Euler and quarters that of the others.
TEST_P(ImplicitTest, OrderOfConvergence) {
  const NodalVector fine = PositionsAfterSteps(SteppingOf(), Element(), 100);
  const NodalVector finer = PositionsAfterSteps(SteppingOf(), Element(), 200);
  const NodalVector finest = PositionsAfterSteps(SteppingOf(), Element(), 400);
  const double order = std::log2(LargestDifference(fine, finer) / LargestDifference(finer, finest));
  std::printf("order %.3f\n", order);
  EXPECT_NEAR(order, SteppingOf() == Stepping::kBackwardEuler ? 1 : 2, 0.2);
  EXPECT_GT(LargestDifference(fine, finer), 1e-9);  // far above the residual of Newton's method
}

// Without external forces momentum is conserved, and energy never grows.
TEST_P(ImplicitTest, Momentum) {
  SteppedRun run(RingingBox(SteppingOf(), Element(), NeoHookean(std::array{1e4, 0.3}), kPeriod / 20));
  Push(run);
  const auto momentum = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t n = 0; n < run.model.nodes(); ++n) sum += run.model.mass()[n] * run.state.velocities[n];
    return sum;
  };
  const Vec3 before = momentum();
  ASSERT_TRUE(run.To(2 * kPeriod));
  EXPECT_LT((momentum() - before).norm(), 1e-9 * before.norm());
  EXPECT_GT((run.state.positions[0] - run.model.rest_positions()[0]).norm(), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Steppings, ImplicitTest,
                         ::testing::Combine(::testing::Values(Stepping::kBackwardEuler, Stepping::kNewmark,
                                                              Stepping::kBdf2),
                                            ::testing::Values(ElementOrder::kLinear, ElementOrder::kQuadratic)),
                         NameOf);

// Largest relative change of the energy over 200 undamped steps of Newmark's method.
double EnergyDrift(const Material& law, ElementOrder element) {
  SteppedRun run(RingingBox(Stepping::kNewmark, element, law, kPeriod / 40));
  Push(run);
  const double start = KineticEnergy(run.model, run.state.velocities, run.team);
  double drift = 0, largest_elastic = 0;
  while (run.state.step < 200) {
    EXPECT_EQ(run.solver.Advance(run.state, 1).problem, StepProblem::kNone);
    const double elastic = ElasticEnergy(run.model, 0, std::array{0.0}, run.state.positions, run.team);
    const double energy = elastic + KineticEnergy(run.model, run.state.velocities, run.team);
    drift = std::max(drift, std::abs(energy / start - 1));
    largest_elastic = std::max(largest_elastic, elastic / start);
  }
  EXPECT_GT(largest_elastic, 0.02);  // it does vibrate
  return drift;
}

// Exact for a linear law; for others the energy fluctuates slightly.
TEST(NewmarkTest, KeepsEnergy) {
  for (const ElementOrder element : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    const double linear = EnergyDrift(LinearElastic(std::array{1e4, 0.3}), element);
    const double nonlinear = EnergyDrift(NeoHookean(std::array{1e4, 0.3}), element);
    std::printf("drift of the energy: linear law %.2g, neo-Hookean %.2g\n", linear, nonlinear);
    EXPECT_LT(linear, 1e-8);
    EXPECT_LT(nonlinear, 0.01);
  }
}

// A nearly incompressible hanging body: quasi-static steps reach the state in which explicit steps come to rest.
TEST(QuasiStaticTest, IsWhereExplicitStepsComeToRest) {
  for (const ElementOrder element : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
    Body body = BoxBody(Vec3(0.02, 0.02, 0.04), {1, 1, 2}, MooneyRivlin(std::array{2e3, 1e3, 6e5}));
    body.constraints = {Fix(kZ1)};
    body.damping.mass_proportional = 100;
    body.density = 1060;
    Scene scene = OneBody(std::move(body));
    scene.gravity = {Vec3(3, 0, -9.81), Curve{{0, 0.05}, {0, 1}, Curve::Interpolation::kSmooth}};
    scene.tet.element = element;
    SteppedRun slow(scene);
    while (slow.state.time < 0.1 || LargestSpeed(slow.state.velocities) > 1e-9)
      ASSERT_TRUE(slow.To(slow.state.time + 0.02));
    scene.tet.stepping = Stepping::kQuasiStatic;
    SteppedRun still(scene);
    ASSERT_TRUE(still.To(0.1));
    double deflection = 0;
    for (std::size_t n = 0; n < still.model.nodes(); ++n)
      deflection = std::max(deflection, still.Displacement(n).norm());
    EXPECT_GT(deflection, 1e-4);
    EXPECT_LT(LargestDifference(slow.state.positions, still.state.positions), 1e-6 * deflection);
  }
}

// Requests a stop after a number of steps.
class StoppingSink : public CollectingSink {
 public:
  explicit StoppingSink(int steps) : steps_(steps) {}
  void PutProgress(const Progress& now) override {
    CollectingSink::PutProgress(now);
    if (now.step == steps_) source.request_stop();
  }

  std::stop_source source;

 private:
  int steps_;
};

TEST(CancelTest, BetweenTwoImplicitSteps) {
  for (const Stepping stepping :
       {Stepping::kBackwardEuler, Stepping::kNewmark, Stepping::kBdf2, Stepping::kQuasiStatic}) {
    Scene scene = StaticScene(LockingCantilever(1, Ramp(1)), ElementOrder::kQuadratic);
    scene.tet.stepping = stepping;
    scene.tet.time_step = 0.1;
    Simulation simulation(std::make_shared<Scene>(scene), 1);
    StoppingSink sink(3);
    EXPECT_EQ(simulation.Run(sink, sink.source.get_token()).kind, Outcome::Kind::kCancelled);
    EXPECT_EQ(sink.progress.step, 3);
    EXPECT_EQ(sink.frames.size(), 1u);  // that of the start
  }
}

}  // namespace
}  // namespace fascicle
