// Problems with other geometries than the references: curved and tapered bodies, oblique fibres, twisting,
// snap-through.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/support/reference_problems.h"
#include "tests/support/static_run.h"
#include "twisted_rod.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr double kPi = std::numbers::pi;

// A box in parameter space, mapped with its mid-edge nodes; sides keep their names.
Body MappedBody(const Vec3& size, const std::array<int, 3>& divisions, const std::function<Vec3(const Vec3&)>& place,
                const Material& law) {
  Body body = BoxBody(size, divisions, law);
  Place(place, body.tet().mesh);
  return body;
}

// A rod of muscle with helical fibres, active, twisted at constant length. Every cylinder in it is sheared uniformly,
// so that torque and axial force are integrals of the law's stress over the radius: in the basis r, theta, z, F = [1 0
// 0; 0 1 kR; 0 0 1] with twist k; radial equilibrium determines the pressure.
struct TwistedRod {
  double radius, twist, winding;
  Muscle law;
  double activation;

  Mat3 CauchyStress(double R) const {
    Mat3 F = Mat3::Identity();
    F(1, 2) = twist * R;
    const FibreState fibre{Vec3(0, std::sin(winding), std::cos(winding)), activation};
    return law.Stress(F, fibre) * F.transpose();
  }
  // By the midpoint rule from the surface inwards.
  RodForces Forces() const {
    constexpr int kSteps = 20000;
    const double h = radius / kSteps;
    double torque = 0, axial = 0, radial = 0;
    for (int k = kSteps - 1; k >= 0; --k) {
      const double R = (k + 0.5) * h;
      const Mat3 s = CauchyStress(R);
      const double slope = (s(1, 1) - s(0, 0)) / R;
      torque += 2 * kPi * R * R * s(1, 2) * h;
      axial += 2 * kPi * R * (s(2, 2) - s(0, 0) + radial - 0.5 * h * slope) * h;
      radial -= h * slope;
    }
    return {torque, axial};
  }
};

TEST(FurtherProblems, TwistedMuscleWithWindingFibres) {
  const Muscle law(std::array{0.03e6, 0.01e6, 4e7, 0.3e6, 1.0, 0.05, 6.6, 1.4});
  for (const double winding : {0.0, 0.35}) {
    const RodForces exact = TwistedRod{kRodRadius, kRodAngle / kRodLength, winding, law, 0.5}.Forces();
    Body body = MakeBody("rod", RodMesh(), law);
    for (std::size_t t = 0; t < body.tet().mesh.tetrahedra.size(); ++t) {
      const Vec3 at = Centroid(body.tet().mesh, t);
      const Vec3 around = Vec3(-at[1], at[0], 0).normalized();
      body.tet().fibres.push_back(std::sin(winding) * around + std::cos(winding) * Vec3::UnitZ());
    }
    std::printf("fibres at %.2f rad: ", winding);
    const RodForces found = TwistRod(std::move(body), 0.5, exact);
    EXPECT_NEAR(found.torque, exact.torque, 0.015 * std::abs(exact.torque));
    EXPECT_NEAR(found.axial, exact.axial, 0.015 * std::abs(exact.axial));
  }
}

// Cook's membrane: a tapered panel in plane strain, nearly incompressible, sheared at its end. n x n x 1 hexahedra.
double CookDeflection(int n, ElementOrder element) {
  const auto place = [](const Vec3& p) {
    const double low = 44 * p[0], high = 44 + 16 * p[0];
    return Vec3(1e-3 * Vec3(48 * p[0], low + (high - low) * p[1], 48.0 / 8 * p[2]));
  };
  const double mu = 80.1938e6;
  Body body = MappedBody(Vec3(1, 1, 1), {n, n, 1}, place, MooneyRivlin(std::array{mu / 2, 0.0, 400.9e9}));
  Constraint flat = Fix(kZ0), flat_too = Fix(kZ1);
  flat.axes = flat_too.axes = {false, false, true};
  body.constraints = {Fix(kX0), flat, flat_too};
  body.loads.push_back({kX1, Traction{Vec3(0, 100e3 / 16e-3, 0)}, Ramp(1), {}});  // 100 N a millimetre of thickness
  SteppedRun run(StaticScene(std::move(body), element));
  EXPECT_TRUE(run.To(1));
  const double deflection = run.DisplacementAt(Vec3(0.048, 0.06, 0))[1];
  std::printf("Cook, %s, %d: %.4f mm, %zu free components, %lld iterations\n",
              element == ElementOrder::kLinear ? "linear" : "quadratic", n, 1e3 * deflection, run.FreeComponents(),
              static_cast<long long>(run.state.iterations));
  return deflection;
}

// A quarter of a ring, clamped at one end, its other end pushed outwards: large bending and rotation. n x n x 4 n
// hexahedra.
double RingDeflection(int n, ElementOrder element) {
  const auto place = [](const Vec3& p) {
    const double angle = 0.5 * kPi * p[2], r = 0.018 + 0.004 * p[0];
    return Vec3(r * std::cos(angle), r * std::sin(angle), 0.004 * p[1]);
  };
  Body body = MappedBody(Vec3(1, 1, 1), {n, n, 6 * n}, place, NearlyIncompressible());
  // The map reverses the orientation of the box.
  for (Tetrahedron& tet : body.tet().mesh.tetrahedra) std::swap(tet[2], tet[3]);
  for (Region& region : body.regions) {
    for (Triangle& t : region.triangles) std::swap(t[1], t[2]);
  }
  body.constraints = {Fix(kZ0)};
  body.loads.push_back({kZ1, Traction{Vec3(0, 1500, 0)}, Ramp(1), {}});
  SteppedRun run(StaticScene(std::move(body), element));
  EXPECT_TRUE(run.To(1));
  const Vec3 moved = run.DisplacementAt(Vec3(0, 0.02, 0.002));
  std::printf("ring, %s, %d: (%.4f %.4f) mm, %zu free components, %lld iterations\n",
              element == ElementOrder::kLinear ? "linear" : "quadratic", n, 1e3 * moved[0], 1e3 * moved[1],
              run.FreeComponents(), static_cast<long long>(run.state.iterations));
  return moved.norm();
}

// Compared with results on finer meshes. The singular corner at the clamped side dominates Cook's membrane: all meshes
// converge as 1/n.
TEST(FurtherProblems, CookMembrane) {
  const double fine = CookDeflection(16, ElementOrder::kQuadratic);
  EXPECT_NEAR(CookDeflection(4, ElementOrder::kQuadratic), fine, 0.06 * fine);
  EXPECT_NEAR(CookDeflection(8, ElementOrder::kQuadratic), fine, 0.015 * fine);
  EXPECT_NEAR(CookDeflection(16, ElementOrder::kLinear), fine, 0.08 * fine);
}

TEST(FurtherProblems, QuarterRing) {
  const double fine = RingDeflection(3, ElementOrder::kQuadratic);
  EXPECT_NEAR(RingDeflection(1, ElementOrder::kQuadratic), fine, 0.04 * fine);
  EXPECT_NEAR(RingDeflection(2, ElementOrder::kQuadratic), fine, 0.01 * fine);
  EXPECT_NEAR(RingDeflection(4, ElementOrder::kLinear), fine, 0.12 * fine);
}

// A flat arch, clamped at both ends, under a dead load in the middle beyond its limit load: it snaps through, and comes
// to rest where an arch with prescribed displacement of the middle has the same force.
Body Arch(int n) {
  const auto place = [](const Vec3& p) {
    return Vec3(0.04 * p[0], 0.004 * p[1], 0.0035 * std::pow(std::sin(kPi * p[0]), 2) + 0.001 * p[2]);
  };
  Body body = MappedBody(Vec3(1, 1, 1), {10 * n, n, n}, place, NeoHookean(std::array{1e6, 0.4}));
  body.constraints = {Fix(kX0), Fix(kX1)};
  Region middle{"middle", {}, {}, {}, {}};
  for (std::size_t k = 0; k < body.tet().mesh.nodes.size(); ++k) {
    if (std::abs(body.tet().mesh.nodes[k][0] - 0.02) < 1e-9) middle.nodes.push_back(static_cast<std::int32_t>(k));
  }
  body.regions.push_back(middle);
  return body;
}
constexpr std::int32_t kMiddle = 6;

TEST(FurtherProblems, AnArchSnapsThrough) {
  // With a prescribed displacement the force has a maximum, the limit load, and decreases beyond it.
  Body drawn = Arch(1);
  Constraint down{kMiddle, {false, false, true}, {}};
  down.motion.translation[2] = Ramp(-0.008);
  drawn.constraints.push_back(down);
  SteppedRun path(StaticScene(std::move(drawn), ElementOrder::kQuadratic));
  double snap_load = 0, valley = INFINITY, before = 0;
  std::vector<std::array<double, 2>> curve;  // displacement [m] and load [N]
  for (int k = 1; k <= 40; ++k) {
    ASSERT_TRUE(path.To(k / 40.0));
    const double load = -path.Reaction(2)[2];
    curve.push_back({0.008 * k / 40, load});
    if (load < before && snap_load == 0) snap_load = before;
    if (snap_load > 0) valley = std::min(valley, load);
    before = load;
  }
  ASSERT_GT(snap_load, 0) << "the arch is too steep or too flat to snap";
  EXPECT_LT(valley, 0.9 * snap_load);

  const double load = 1.2 * snap_load;
  Body pressed = Arch(1);
  pressed.loads.push_back({kMiddle, NodalForce{Vec3(0, 0, -load)}, Ramp(1), {}});
  for (const double time_step : {1.0, 0.05}) {
    Scene scene = StaticScene(pressed, ElementOrder::kQuadratic);
    scene.tet.time_step = time_step;
    SteppedRun run(scene);
    ASSERT_TRUE(run.To(1)) << "stopped at " << run.state.time;
    const double way = -run.DisplacementAt(Vec3(0.02, 0.002, 0.0035))[2];
    double expected = 0;
    for (std::size_t k = 1; k < curve.size(); ++k) {
      const auto& [w0, f0] = curve[k - 1];
      const auto& [w1, f1] = curve[k];
      if (f0 <= load && f1 > load) expected = w0 + (w1 - w0) * (load - f0) / (f1 - f0);
    }
    std::printf(
        "arch: snaps at %.4f N, valley %.4f N; at %.4f N in steps of %.2f it is down by %.3f mm, drawn %.3f mm; "
        "%lld steps, %lld iterations\n",
        snap_load, valley, load, time_step, 1e3 * way, 1e3 * expected, static_cast<long long>(run.state.step),
        static_cast<long long>(run.state.iterations));
    EXPECT_NEAR(way, expected, 0.03 * expected);
  }
}

}  // namespace
}  // namespace fascicle
