// Viscoelastic materials against the closed forms of linear viscoelasticity and of incompressible bodies.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <vector>

#include "core/materials/uniaxial_curve.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr double kBarSide = 0.01, kBarLength = 0.04;  // of a bar along z [m]

// A bar with free sides; its end moves as `end` says, or is free where there is none.
Body Bar(const Material& law, const PronySeries& series, const std::vector<Curve>& end) {
  Body body = BoxBody(Vec3(kBarSide, kBarSide, kBarLength), {1, 1, 2}, law);
  body.viscoelasticity = series;
  body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3::UnitZ());
  body.constraints = {Fix(kX0, {true, false, false}), Fix(kY0, {false, true, false}), Fix(kZ0, {false, false, true})};
  if (!end.empty()) {
    body.constraints.push_back(Fix(kZ1, {false, false, true}));
    body.constraints.back().motion.translation[2] = end[0];
  }
  return body;
}

// Suddenly stretched by a half and held: S_p stays, so the stress of an incompressible bar is 1 + sum g exp(-t/tau)
// times that of the law.
TEST(ViscoelasticTest, RelaxationOfAStretchedBar) {
  const PronySeries series = {{{0.5, 0.1}, {0.3, 1}}};
  constexpr double kRise = 1e-4, kStretch = 1.5;
  const std::vector<Material> laws = {MooneyRivlin(std::array{1e4, 5e3, 1e9}),
                                      FungFibre(std::array{1e4, 5e3, 2e4, 1.0, 1e9}),
                                      Ogden(std::array{6e4, 1.3, 600.0, 5.0, 2e3, -2.0, 1e9})};
  for (const Material& law : laws) {
    for (const ElementOrder element : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
      const Curve end = {{0, kRise}, {0, (kStretch - 1) * kBarLength}, Curve::Interpolation::kLinear};
      SteppedRun run(StaticScene(Bar(law, series, {end}), element));
      const UniaxialPoint rest = UniaxialTension(law, 0, kStretch);
      ASSERT_TRUE(rest.converged);
      ASSERT_TRUE(run.To(kRise));
      double worst = 0;
      for (const double time : {kRise, 0.02, 0.1, 0.3, 0.7, 1.0}) {
        ASSERT_TRUE(time == kRise || run.To(time));
        double factor = 1;
        for (const PronyTerm& term : series.terms) factor += term.strength * std::exp(-(time - kRise / 2) / term.time);
        const double nominal = run.Reaction(3)[2] / (kBarSide * kBarSide);
        worst = std::max(worst, std::abs(nominal / (factor * rest.nominal_stress) - 1));
      }
      std::printf("relaxation, %s %d: largest difference %.2g, %lld iterations in %lld steps\n",
                  std::visit([](const auto& l) { return l.kName; }, law), static_cast<int>(element), worst,
                  static_cast<long long>(run.state.iterations), static_cast<long long>(run.state.step));
      EXPECT_LT(worst, 0.005);
    }
  }
}

// Muscle: what is active does not relax. Isometric and activated, the bar relaxes by its passive part only.
TEST(ViscoelasticTest, ActivationDoesNotRelax) {
  const Muscle law(std::array{500.0, 500.0, 1e7, 3e5, 1.4, 0.05, 6.6, 1.4});
  const PronySeries series = {{{0.6, 0.1}}};
  constexpr double kRise = 1e-4, kStretch = 1.6;
  Body body = Bar(law, series, {{{0, kRise}, {0, (kStretch - 1) * kBarLength}, Curve::Interpolation::kLinear}});
  body.activation = {{0, kRise}, {0, 0.5}, Curve::Interpolation::kLinear};
  SteppedRun run(StaticScene(body, ElementOrder::kQuadratic));
  const double passive = UniaxialTension(law, 0, kStretch).nominal_stress;
  const double whole = UniaxialTension(law, 0.5, kStretch).nominal_stress;
  ASSERT_TRUE(run.To(kRise));
  for (const double time : {0.05, 0.2, 0.9}) {
    ASSERT_TRUE(run.To(time));
    const double expected = whole + 0.6 * std::exp(-(time - kRise / 2) / 0.1) * passive;
    // The volume, which the active stress changes, adds about stress/K.
    EXPECT_NEAR(run.Reaction(3)[2] / (kBarSide * kBarSide), expected, 0.005 * expected) << time;
  }
}

// Small strains e sin(wt): the stress is that of the complex modulus E (1 + g iwt/(1 + iwt)), and each cycle dissipates
// pi e^2 times its imaginary part.
TEST(ViscoelasticTest, LossOfACycle) {
  constexpr double kStrain = 1e-3, kCyclePeriod = 0.5, kG = 0.8, kTau = 0.1;
  constexpr int kPoints = 100, kCycles = 6;
  const MooneyRivlin law(std::array{1e4, 5e3, 1e8});
  Curve end = {{}, {}, Curve::Interpolation::kLinear};
  for (int i = 0; i <= kPoints * kCycles; ++i) {
    end.times.push_back(kCyclePeriod * i / kPoints);
    end.values.push_back(kStrain * kBarLength * std::sin(2 * std::numbers::pi * i / kPoints));
  }
  Scene scene = StaticScene(Bar(law, {{{kG, kTau}}}, {end}), ElementOrder::kQuadratic);
  scene.duration = kCyclePeriod * kCycles;
  scene.tet.time_step = kCyclePeriod / kPoints;
  SteppedRun run(scene);
  const double modulus = 3 * law.ShearModulus();  // of an incompressible bar
  const std::complex<double> iwt(0, 2 * std::numbers::pi / kCyclePeriod * kTau);
  const std::complex<double> complex_modulus = modulus * (1.0 + kG * iwt / (1.0 + iwt));
  double before = 0, worst = 0;
  for (int i = 1; i <= kPoints * kCycles; ++i) {
    ASSERT_TRUE(run.To(end.times[static_cast<std::size_t>(i)]));
    if (i == kPoints * (kCycles - 1)) before = run.state.dissipated;
    if (i <= kPoints * (kCycles - 1)) continue;
    const double phase = 2 * std::numbers::pi * i / kPoints;
    const double expected =
        kStrain * (complex_modulus.real() * std::sin(phase) + complex_modulus.imag() * std::cos(phase));
    worst = std::max(
        worst, std::abs(run.Reaction(3)[2] / (kBarSide * kBarSide) - expected) / (kStrain * std::abs(complex_modulus)));
  }
  const double loss = run.state.dissipated - before;
  const double exact = std::numbers::pi * kStrain * kStrain * complex_modulus.imag() * kBarSide * kBarSide * kBarLength;
  std::printf("cycle: loss %.6g J, exact %.6g J, %+.2g; stress within %.2g of its amplitude\n", loss, exact,
              loss / exact - 1, worst);
  EXPECT_NEAR(loss, exact, 0.005 * exact);
  EXPECT_LT(worst, 0.005);
  // What the supports have done is stored or dissipated.
  const double stored = ElasticEnergy(run.model, 0, FibreDrive{std::vector<double>{0}}, run.state.positions, run.team);
  EXPECT_NEAR(run.state.external_work, stored + run.state.dissipated, 1e-3 * run.state.external_work);
}

// A small constant load: the standard linear solid creeps to sigma/E as 1 - g/(1 + g) exp(-t/(tau (1 + g))).
TEST(ViscoelasticTest, CreepUnderALoad) {
  constexpr double kG = 1.5, kTau = 0.1, kTraction = 20;
  const MooneyRivlin law(std::array{1e4, 5e3, 1e8});
  Body body = Bar(law, {{{kG, kTau}}}, {});
  body.loads.push_back(
      {kZ1, Traction{Vec3(0, 0, kTraction)}, Curve{{0, 1e-5}, {0, 1}, Curve::Interpolation::kLinear}, {}});
  Scene scene = StaticScene(body, ElementOrder::kQuadratic);
  scene.tet.time_step = 0.005;
  SteppedRun run(scene);
  ASSERT_TRUE(run.To(1e-5));
  double worst = 0;
  for (const double time : {0.02, 0.1, 0.2, 0.5, 1.0}) {
    ASSERT_TRUE(run.To(time));
    const double strain = run.DisplacementAt(Vec3(0, 0, kBarLength))[2] / kBarLength;
    const double exact =
        kTraction / (3 * law.ShearModulus()) * (1 - kG / (1 + kG) * std::exp(-time / (kTau * (1 + kG))));
    worst = std::max(worst, std::abs(strain / exact - 1));
  }
  std::printf("creep: largest difference %.2g\n", worst);
  EXPECT_LT(worst, 0.005);
}

// Every stepping relaxes to the same force, and accounts for the work.
TEST(ViscoelasticTest, AllSteppingsAgree) {
  const auto scene_of = [](Stepping stepping) {
    const Curve end = {{0, 0.1}, {0, 0.2 * kBarLength}, Curve::Interpolation::kSmooth};
    Body body = Bar(NeoHookean(std::array{3e4, 0.3}), {{{1.0, 0.2}}}, {end});
    body.density = 1000;
    // Without damping, of which implicit steps do not report the work, the slow motion leaves little vibration.
    const bool is_explicit = stepping == Stepping::kExplicit || stepping == Stepping::kMixed;
    if (is_explicit) body.damping.mass_proportional = 100;
    Scene scene = OneBody(body);
    scene.tet.stepping = stepping;
    scene.duration = 0.4;
    scene.output.frame_interval = 0.1;
    if (!is_explicit) scene.tet.time_step = 0.002;
    return scene;
  };
  const RunResult expected = RunScene(scene_of(Stepping::kQuasiStatic));
  for (const Stepping stepping : {Stepping::kExplicit, Stepping::kMixed, Stepping::kBackwardEuler, Stepping::kNewmark,
                                  Stepping::kBdf2, Stepping::kQuasiStatic}) {
    const RunResult run = RunScene(scene_of(stepping));
    ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
    for (const std::size_t frame : {2u, 4u}) {
      const double force = run.At(frame, "box/reaction/z1/z"), exact = expected.At(frame, "box/reaction/z1/z");
      EXPECT_NEAR(force, exact, 0.005 * exact) << static_cast<int>(stepping);
    }
    const double balance = run.Last("energy/elastic") + run.Last("energy/kinetic") + run.Last("energy/dissipated") -
                           run.Last("energy/external_work");
    std::printf("stepping %d: force %.6g N, dissipated %.6g J, balance %.2g J\n", static_cast<int>(stepping),
                run.Last("box/reaction/z1/z"), run.Last("energy/dissipated"), balance);
    EXPECT_GT(run.Last("energy/dissipated"), 0);
    EXPECT_NEAR(balance, 0, 0.01 * run.Last("energy/external_work")) << static_cast<int>(stepping);
  }
}

}  // namespace
}  // namespace fascicle
