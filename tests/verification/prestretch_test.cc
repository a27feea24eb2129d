// Prestretched fibres against closed forms of incompressible bars.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr double kBarWidth = 0.01, kRestLength = 0.04;  // [m]
constexpr double kMatrixC1 = 2e4, kMatrixC2 = 1e4;      // [Pa]

// A bar along z with free sides, of fibres with a prestretch.
Body PrestretchedBar(const Material& law, double prestretch) {
  Body body = BoxBody(Vec3(kBarWidth, kBarWidth, kRestLength), {2, 2, 4}, law);
  body.tet().fibres = ConstantFibres(body.tet().mesh, Vec3::UnitZ());
  body.tet().prestretch.assign(body.tet().mesh.tetrahedra.size(), prestretch);
  body.constraints = {Fix(kX0, {true, false, false}), Fix(kY0, {false, true, false}), Fix(kZ0, {false, false, true})};
  return body;
}

// Held at its length the bar pulls with the fibre stress at the prestretch; released, it shortens until its matrix
// bears that of the fibres: 2 (l^2 - 1/l)(c1 + c2/l) + sigma(p l) = 0.
TEST(PrestretchTest, HeldAndReleasedBar) {
  const Tendon tendon(std::array{kMatrixC1, kMatrixC2, 1e10, 2e5, 10.0, 1.15});
  const Muscle muscle(std::array{kMatrixC1, kMatrixC2, 1e10, 1e5, 1.0, 0.2, 5.0, 1.4});
  for (const Material& law : {Material(tendon), Material(muscle)}) {
    for (const ElementOrder element : {ElementOrder::kLinear, ElementOrder::kQuadratic}) {
      for (const double prestretch : {1.05, 1.2, 1.5}) {
        const auto fibre_stress = [&](double stretch) {
          return std::holds_alternative<Tendon>(law) ? tendon.FibreStress(stretch) : muscle.FibreStress(stretch, 0);
        };
        Body held = PrestretchedBar(law, prestretch);
        held.constraints.push_back(Fix(kZ1, {false, false, true}));
        SteppedRun run(StaticScene(held, element));
        ASSERT_TRUE(run.To(1));
        const double pull = run.Reaction(3)[2] / (kBarWidth * kBarWidth);
        EXPECT_NEAR(pull, fibre_stress(prestretch), 1e-3 * fibre_stress(prestretch));

        SteppedRun released(StaticScene(PrestretchedBar(law, prestretch), element));
        ASSERT_TRUE(released.To(1));
        double low = 1 / prestretch, high = 1;
        while (high - low > 1e-14) {
          const double l = 0.5 * (low + high);
          (2 * (l * l - 1 / l) * (kMatrixC1 + kMatrixC2 / l) + fibre_stress(prestretch * l) > 0 ? high : low) = l;
        }
        const double stretch = 1 + released.DisplacementAt(Vec3(0, 0, kRestLength))[2] / kRestLength;
        std::printf("prestretch %.2f: pull %.6g Pa, exact %.6g; released to %.6f, exact %.6f\n", prestretch, pull,
                    fibre_stress(prestretch), stretch, low);
        EXPECT_NEAR(stretch, low, 1e-4);
        EXPECT_LT(low, 0.995);
      }
    }
  }
}

// The activation's optimum moves with the prestretch: fibres of stretch 1 in the mesh pull as those of stretch p.
TEST(PrestretchTest, ShiftsTheActiveCurve) {
  const Muscle law(std::array{500.0, 0.0, 1e9, 1e5, 1.3, 0.0, 5.0, 1.4});
  for (const double prestretch : {0.8, 1.0, 1.3}) {
    Body body = PrestretchedBar(law, prestretch);
    body.constraints.push_back(Fix(kZ1, {false, false, true}));
    body.activation = Ramp(1);
    SteppedRun run(StaticScene(body, ElementOrder::kQuadratic));
    ASSERT_TRUE(run.To(1));
    EXPECT_NEAR(run.Reaction(3)[2] / (kBarWidth * kBarWidth), law.FibreStress(prestretch, 1),
                1e-3 * law.FibreStress(prestretch, 1));
  }
}

}  // namespace
}  // namespace fascicle
