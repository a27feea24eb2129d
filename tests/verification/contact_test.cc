// Contact against the theory of Hertz [Johnson 1985, Contact Mechanics, 4.2].
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/tet/contact.h"
#include "tests/support/static_run.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr double kBlockYoung = 1e5, kBlockPoisson = 0.3;
constexpr double kBlockModulus = kBlockYoung / (1 - kBlockPoisson * kBlockPoisson);  // E* beside a rigid body

// Distances from the middle of the contact: they grow by a constant ratio from `least` to `most`.
struct Grading {
  double least, most;
  int divisions;

  // At u in [0, 1].
  double At(double u) const {
    double low = 1.0001, high = 3;
    for (int k = 0; k < 100; ++k) {
      const double ratio = 0.5 * (low + high);
      (least * (std::pow(ratio, divisions) - 1) / (ratio - 1) < most ? low : high) = ratio;
    }
    return least * (std::pow(low, divisions * u) - 1) / (low - 1);
  }
};

// A block below z = 0 that is fine at the origin.
Body GradedBlock(const Grading& along, const Grading& across, bool is_plane) {
  TetMesh mesh = MakeBox(Vec3::Zero(), Vec3::Ones(),
                         {along.divisions, is_plane ? 1 : across.divisions, across.divisions}, Cells::kHexahedra);
  for (Vec3& X : mesh.nodes) {
    X = Vec3(along.At(X[0]), is_plane ? along.least * X[1] : across.At(X[1]), -across.At(1 - X[2]));
  }
  Body body = MakeBody("block", std::move(mesh), LinearElastic(std::array{kBlockYoung, kBlockPoisson}));
  body.constraints = {Fix(kX0, {true, false, false}), Fix(kY0, {false, true, false}), Fix(kZ0)};
  if (is_plane) body.constraints.push_back(Fix(kY1, {false, true, false}));
  return body;
}

// Presses a rigid body, which touches the origin, down by an approach.
Scene Indentation(Body block, ObstacleShape shape, double radius, double approach) {
  Scene scene = StaticScene(std::move(block), ElementOrder::kHexahedral);
  RigidBody rigid{"indenter", std::move(shape), {Vec3(0, 0, radius), {1, 0, 0, 0}}, Motion(), {}, "", 0, {}};
  rigid.motion->translation[2] = Curve{{0, 1}, {0, -approach}};
  scene.rigid_bodies = {rigid};
  return scene;
}

struct Indented {
  double force = 0, peak = 0, reach = 0;  // [N], pressure at the origin [Pa], of the contact along x [m]
  double relative_depth = 0;
};
Indented Measure(SteppedRun& run, double area_at_origin) {
  const Controls end = ControlSource(run.scene).At(1);
  Indented found;
  const std::vector<Touch> touches = TouchesOf(run.model, run.state, end, run.team);
  const std::vector<ContactSum> contacts = SumsOfRigidBodies(PlacementsOf(run.model, end), touches);
  found.force = contacts[0].force[2];
  found.relative_depth = contacts[0].excess;
  for (const Touch& touch : touches) {
    const std::int32_t n = touch.nodes[0];
    const Vec3& X = run.model.rest_positions()[static_cast<std::size_t>(n)];
    if (X.norm() == 0) found.peak = touch.response.force / area_at_origin;
    found.reach = std::max(found.reach, X[0]);
  }
  return found;
}

// A ball on a plane: F = 4/3 E* R^(1/2) d^(3/2), p0 = 2 E* a / (pi R), a^2 = R d.
TEST(HertzTest, BallOnPlane) {
  const double R = 0.05, a = 0.002, approach = a * a / R;
  const Grading grading = {0.15 * a, 100 * a, 20};
  SteppedRun run(Indentation(GradedBlock(grading, grading, false), Ball{R}, R, approach), 2);
  ASSERT_TRUE(run.To(1));
  const Indented found = Measure(run, grading.least * grading.least / 4);
  const double force = 4. / 3 * kBlockModulus * std::sqrt(R) * std::pow(approach, 1.5) / 4;  // on a quarter
  const double peak = 2 * kBlockModulus * a / (std::numbers::pi * R);
  std::printf("ball: force %.4f, peak %.4f, reach %.3f of Hertz; depth %.3f of the allowed\n", found.force / force,
              found.peak / peak, found.reach / a, found.relative_depth);
  EXPECT_NEAR(found.force, force, 0.03 * force);
  EXPECT_NEAR(found.peak, peak, 0.03 * peak);
  EXPECT_NEAR(found.reach, a, 0.3 * a) << "the size of an element there";
  EXPECT_LT(found.relative_depth, 1);
}

// A cylinder on a plane: b^2 = 4 F' R / (pi E*), p0 = 2 F' / (pi b), with the force F' per length.
TEST(HertzTest, CylinderOnPlane) {
  const double R = 0.05, b = 0.002;
  const Grading grading = {0.06 * b, 60 * b, 48};
  Body block = GradedBlock(grading, grading, true);
  const double thickness = grading.least;
  Scene scene = Indentation(std::move(block), Cylinder{R, 1}, R, 2.2e-4);
  scene.rigid_bodies[0].pose.quaternion = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};  // along y
  SteppedRun run(scene, 2);
  ASSERT_TRUE(run.To(1));
  const Indented found = Measure(run, grading.least * thickness / 4);
  const double per_length = 2 * found.force / thickness;
  const double width = std::sqrt(4 * per_length * R / (std::numbers::pi * kBlockModulus));
  const double peak = 2 * per_length / (std::numbers::pi * width);
  std::printf("cylinder: half width %.3g m, peak %.4f, reach %.3f of Hertz; depth %.3f of the allowed\n", width,
              found.peak / peak, found.reach / width, found.relative_depth);
  EXPECT_GT(width, 0.5 * b);
  EXPECT_LT(width, 2 * b);
  EXPECT_NEAR(found.peak, peak, 0.03 * peak);
  EXPECT_NEAR(found.reach, width, 0.1 * width) << "the size of an element there";
  EXPECT_LT(found.relative_depth, 1);
}

}  // namespace
}  // namespace fascicle
