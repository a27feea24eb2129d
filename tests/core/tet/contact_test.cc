// Bodies that touch rigid bodies.
#include "core/tet/contact.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/sim/control_source.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;

constexpr double kCubeSize = 0.02;

RigidBody Rigid(const std::string& name, ObstacleShape shape, const Vec3& position) {
  return {name, std::move(shape), {position, {1, 0, 0, 0}}, {}, {}, "", 0, {}};
}

// A cube of 2 cm at the origin with a side on z = 0.
Scene CubeScene(Stepping stepping, ElementOrder element, const std::array<int, 3>& divisions = {3, 3, 3}) {
  Scene scene;
  scene.bodies = {BoxBody(Vec3::Constant(kCubeSize), divisions, NeoHookean(std::array{2e4, 0.3}), CellsOf(element))};
  scene.tet.stepping = stepping;
  scene.tet.element = element;
  scene.duration = 1;
  scene.output.frame_interval = 0.25;
  return scene;
}

Motion Along(int axis, Curve curve) {
  Motion motion;
  motion.translation[static_cast<std::size_t>(axis)] = std::move(curve);
  return motion;
}

double RigidForce(const RunResult& run, const std::string& name, char axis) {
  return run.Last("contact/" + name + "/force/" + axis);
}

// A surface of triangles with the shape of a bar.
TriangleMesh Bar() {
  const ObstacleShape box = Cuboid{Vec3(0.006, 0.05, 0.006)};
  return SurfaceOf(box, 1);
}

// The force of contact is minus the gradient of its energy, on every element and shape; with a start, that of its
// potential.
TEST(ContactTest, ForceIsTheSlopeOfTheEnergy) {
  for (const ElementOrder element : kEveryElement) {
    for (const Stepping stepping : {Stepping::kExplicit, Stepping::kNewmark}) {
      Scene scene = CubeScene(stepping, element);
      scene.rigid_bodies = {Rigid("plane", HalfSpace(), Vec3(0, 0, 0.001)),
                            Rigid("ball", Ball{0.01}, Vec3(0.01, 0.01, 0.0285)),
                            Rigid("bone", Cylinder{0.008, 0.03}, Vec3(-0.007, 0.01, 0.01)),
                            Rigid("bar", Bar(), Vec3(0.022, 0.01, 0.012))};
      const TetModel model(scene);
      ThreadTeam team(2);
      const NodalVector start = Shaken(model.rest_positions(), 3e-4, 1), x = Shaken(start, 3e-4, 2);
      const NodalVector direction = RandomVectors(x.size(), 3);
      ContactDrive drive = {PlacementsOf(model, {}), 1.5, &start, nullptr, {}};
      if (stepping == Stepping::kNewmark) {
        drive.start = &start;
        drive.at_start = drive.now;
      }
      ContactSearch search(model);
      NodalVector force(x.size(), Vec3::Zero());
      std::vector<bool> touched(4, false);
      for (const Touch& touch : search.Find(drive, x, team)) touched[static_cast<std::size_t>(touch.rigid)] = true;
      EXPECT_EQ(touched, std::vector<bool>(4, true));
      AddContactForce(search.touches(), force);
      const double h = 1e-8;
      NodalVector ahead = x, behind = x;
      double slope = 0;
      for (std::size_t n = 0; n < x.size(); ++n) {
        ahead[n] += h * direction[n];
        behind[n] -= h * direction[n];
        slope += force[n].dot(direction[n]);
      }
      const double difference =
          (ContactEnergy(search.Find(drive, ahead, team)) - ContactEnergy(search.Find(drive, behind, team))) / (2 * h);
      EXPECT_NEAR(-slope, difference, 1e-5 * std::abs(slope)) << ElementNameOf(element);
      // The blocks are the derivative of the force.
      NodalVector product(x.size(), Vec3::Zero()), change(x.size(), Vec3::Zero()), back(x.size(), Vec3::Zero());
      search.Find(drive, x, team);
      ForContactStiffness(search.touches(), false, [&](std::int32_t row, std::int32_t column, const Mat3& block) {
        product[row] += block * direction[column];
      });
      AddContactForce(search.Find(drive, ahead, team), change);
      AddContactForce(search.Find(drive, behind, team), back);
      double size = 0;
      for (std::size_t n = 0; n < x.size(); ++n) {
        product[n] += (change[n] - back[n]) / (2 * h);
        size = std::max(size, ((change[n] - back[n]) / (2 * h)).norm());
      }
      EXPECT_LT(LargestNorm(product), 1e-4 * size) << ElementNameOf(element);
    }
  }
}

// A plate that is pressed on a cube whose sides are free: the pressure is the same everywhere, for every element; force
// and moment balance; the plate's work is the energy that the cube stores.
TEST(ContactTest, APlateGivesAUniformPressure) {
  for (const ElementOrder element : kEveryElement) {
    Scene scene = CubeScene(Stepping::kQuasiStatic, element);
    scene.bodies[0].constraints = {Fix(kX0, {true, false, false}), Fix(kY0, {false, true, false}),
                                   Fix(kZ0, {false, false, true})};
    RigidBody plate = Rigid("plate", HalfSpace(), Vec3(0, 0, kCubeSize));
    plate.pose.quaternion = {0, 1, 0, 0};  // faces down
    plate.motion = Along(2, Curve{{0, 1}, {0, -0.004}});
    scene.rigid_bodies = {plate};
    scene.output.fields = {OutputField::kCauchyStress};
    const RunResult run = RunScene(scene, 2);
    ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
    const std::vector<double>& stress = run.frames.back().bodies[0].fields[0].values;
    for (std::size_t e = 0; e < stress.size() / 6; ++e) {
      EXPECT_NEAR(stress[6 * e + 2], stress[2], 1e-5 * std::abs(stress[2])) << ElementNameOf(element);
    }
    const double force = RigidForce(run, "plate", 'z');
    EXPECT_GT(force, 1);
    EXPECT_NEAR(force, run.Last("box/reaction/z0/z"), 1e-6 * force);
    // About the corner of the cube, which has grown by 5 to 8 %.
    EXPECT_NEAR(run.Last("contact/plate/moment/x"), 1.06 * kCubeSize / 2 * force, 0.03 * kCubeSize / 2 * force);
    EXPECT_NEAR(run.Last("contact/plate/moment/y"), -run.Last("contact/plate/moment/x"), 1e-6 * force * kCubeSize);
    const double work = run.Last("energy/external_work");
    EXPECT_NEAR(run.Last("energy/elastic") + run.Last("energy/contact"), work, 1e-3 * work);
    EXPECT_LT(run.Last("contact/plate/relative_depth"), 1);
  }
}

// A ball thrown against a rod, off its middle, flies on with its energy.
TEST(ContactTest, ABounceKeepsTheEnergy) {
  for (const Stepping stepping : {Stepping::kExplicit, Stepping::kNewmark}) {
    Scene scene;
    scene.bodies = {MakeBody("ball", MakeSphere(0.01, 4), NeoHookean(std::array{2e4, 0.3}))};
    scene.bodies[0].tet().initial_velocity.assign(scene.bodies[0].tet().mesh.nodes.size(), Vec3(0, 0, -0.5));
    scene.rigid_bodies = {Rigid("rod", Cylinder{0.008, 0.1}, Vec3(0.004, 0, -0.02))};
    scene.rigid_bodies[0].pose.quaternion = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};  // along y
    scene.tet.stepping = stepping;
    scene.tet.element = ElementOrder::kLinear;
    if (stepping == Stepping::kNewmark) scene.tet.time_step = 2e-4;
    scene.duration = 0.03;
    scene.output.frame_interval = 0.0015;
    const RunResult run = RunScene(scene, 2);
    ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
    const double start = run.At(0, "energy/kinetic");
    double push = 0;
    for (std::size_t k = 0; k < run.frames.size(); ++k) {
      const double sum = run.At(k, "energy/kinetic") + run.At(k, "energy/elastic") + run.At(k, "energy/contact");
      EXPECT_NEAR(sum, start, 0.01 * start) << run.frames[k].time;
      push = std::max(push, -run.At(k, "contact/rod/force/z"));
      EXPECT_LT(run.At(k, "contact/rod/relative_depth"), 1);
    }
    EXPECT_GT(push, 0.5);
    EXPECT_EQ(run.Last("contact/rod/force/z"), 0) << "it has left the rod";
    EXPECT_GT(run.At(8, "energy/elastic"), 0.02 * start);
  }
}

// A muscle-like bar is bent over a cylinder by the motion of its ends: it slides, and stays outside.
TEST(ContactTest, ABarSlidesOverACylinder) {
  for (const Stepping stepping :
       {Stepping::kQuasiStatic, Stepping::kBackwardEuler, Stepping::kBdf2, Stepping::kMixed}) {
    Scene scene;
    scene.bodies = {BoxBody(Vec3(0.06, 0.01, 0.006), {16, 2, 2}, NeoHookean(std::array{2e4, 0.4}))};
    scene.bodies[0].damping.mass_proportional = 30;
    scene.tet.stepping = stepping;
    scene.tet.element = stepping == Stepping::kMixed ? ElementOrder::kLinear : ElementOrder::kQuadratic;
    scene.rigid_bodies = {Rigid("bone", Cylinder{0.01, 0.1}, Vec3(0.03, 0.005, -0.0102))};
    scene.rigid_bodies[0].pose.quaternion = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};
    Constraint left = Fix(kX0), right = Fix(kX1);
    left.motion = Along(2, Curve{{0, 0.1, 0.2}, {0, -0.012, -0.012}, Curve::Interpolation::kSmooth});
    left.motion.translation[0] = Curve{{0, 0.1, 0.2}, {0, 0, -0.006}, Curve::Interpolation::kSmooth};
    right.motion = left.motion;
    scene.bodies[0].constraints = {left, right};
    scene.duration = 0.2;
    scene.output.frame_interval = 0.02;
    const RunResult run = RunScene(scene, 2);
    ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << static_cast<int>(stepping) << run.outcome.failure.message;
    for (std::size_t k = 0; k < run.frames.size(); ++k) {
      EXPECT_LT(run.At(k, "contact/bone/relative_depth"), 1) << k << " " << static_cast<int>(stepping);
    }
    EXPECT_LT(RigidForce(run, "bone", 'z'), -0.05);
    const double ends = run.Last("box/reaction/x0/z") + run.Last("box/reaction/x1/z");
    if (stepping == Stepping::kQuasiStatic) {
      EXPECT_NEAR(ends, RigidForce(run, "bone", 'z'), 1e-4 * std::abs(ends));
    }
  }
}

// What a support holds inside of a rigid body is not pushed.
TEST(ContactTest, HeldNodesAreNotPushed) {
  Scene scene = CubeScene(Stepping::kQuasiStatic, ElementOrder::kLinear);
  scene.bodies[0].constraints = {Fix(kZ0)};
  scene.rigid_bodies = {Rigid("bone", HalfSpace(), Vec3(0, 0, 0.003))};
  const RunResult run = RunScene(scene, 1);
  ASSERT_EQ(run.outcome.kind, Outcome::Kind::kSucceeded) << run.outcome.failure.message;
  EXPECT_EQ(RigidForce(run, "bone", 'z'), 0);
}

}  // namespace
}  // namespace fascicle
