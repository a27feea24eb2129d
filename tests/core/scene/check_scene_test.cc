#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/scene/scene.h"
#include "tests/support/full_scenes.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;
using ::testing::HasSubstr;

Scene GoodScene() {
  Body body = BoxBody(Vec3(0.03, 0.02, 0.02), {3, 2, 2}, Muscle(std::array{5e2, 5e2, 1e5, 3e4, 1.2, 0.05, 6.6, 1.4}));
  body.constraints.push_back(Fix(kX0));
  body.loads.push_back({kX1, Traction{Vec3(0, 0, -50)}, Curve::Constant(1), {}});
  body.activation = {{0, 1}, {0, 1}, Curve::Interpolation::kSmooth};
  Scene scene = OneBody(body);
  scene.gravity.acceleration = Vec3(0, 0, -9.81);
  scene.output.probes = {{"tip", 0, 3}};
  return scene;
}

// The only problem that a change causes.
Problem ProblemOf(const Scene& scene) {
  Problems problems;
  CheckScene(scene, problems);
  EXPECT_EQ(problems.count(), 1u) << problems.ToString();
  return problems.empty() ? Problem{} : problems.kept()[0];
}

TEST(CheckSceneTest, GoodSceneHasNoProblems) {
  Problems problems;
  CheckScene(GoodScene(), problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
}

TEST(CheckSceneTest, NoBodies) {
  Scene scene = GoodScene();
  scene.bodies.clear();
  scene.output.probes.clear();
  EXPECT_EQ(ProblemOf(scene).path, "bodies");
}

TEST(CheckSceneTest, BodyWithoutMass) {
  Scene scene = GoodScene();
  scene.bodies[0].density = 0;
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].density");
}

TEST(CheckSceneTest, NamesMustDiffer) {
  Scene scene = GoodScene();
  scene.bodies.push_back(scene.bodies[0]);
  EXPECT_EQ(ProblemOf(scene).path, "bodies[1].name");
}

TEST(CheckSceneTest, FibresAreMissing) {
  Scene scene = GoodScene();
  scene.bodies[0].tet().fibres.clear();
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].fibres");
  scene.bodies[0].material = NeoHookean(std::array{1e4, 0.3});
  Problems problems;
  CheckScene(scene, problems);
  EXPECT_TRUE(problems.empty());
}

TEST(CheckSceneTest, FibresOfAnotherMesh) {
  Scene scene = GoodScene();
  scene.bodies[0].tet().fibres.pop_back();
  EXPECT_THAT(ProblemOf(scene).message, HasSubstr("71 fibre directions for 72"));
}

TEST(CheckSceneTest, FibreThatIsNoDirection) {
  Scene scene = GoodScene();
  scene.bodies[0].tet().fibres[5] *= 2;
  EXPECT_THAT(ProblemOf(scene).message, HasSubstr("element 5"));
}

// Two families of fibres need a plane: the body's reference direction must not be that of a fibre.
TEST(CheckSceneTest, FibresAlongTheReferenceDirection) {
  const auto law = [](double gamma, double z) {
    return HolzapfelGasserOgden(std::array{6e3, 5e3, 2.0, 0.1, gamma, 0.0, 0.0, z, 2e4});
  };
  Scene scene = GoodScene();
  Body& body = scene.bodies[0];
  body.material = law(0.6, 1);
  Problems none;
  CheckScene(scene, none);
  EXPECT_TRUE(none.empty()) << none.ToString();
  body.tet().fibres[5] = -Vec3::UnitZ();
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].fibres");
  EXPECT_THAT(ProblemOf(scene).message, HasSubstr("element 5"));
  // With gamma = 0 there is no plane; a part without families does not need it.
  body.material = law(0, 1);
  CheckScene(scene, none);
  EXPECT_TRUE(none.empty()) << none.ToString();
  body.material = law(0.6, 1);
  body.tet().materials.more = {NeoHookean(std::array{1e4, 0.3})};
  body.tet().materials.of.assign(body.tet().mesh.tetrahedra.size(), 0);
  body.tet().materials.of[5] = 1;
  CheckScene(scene, none);
  EXPECT_TRUE(none.empty()) << none.ToString();
  // Without a reference direction, no element has it.
  body.material = law(0.6, 0);
  EXPECT_THAT(ProblemOf(scene).message, HasSubstr("element 0"));
}

TEST(CheckSceneTest, FibresThatOnlyAPartNeeds) {
  Scene scene = GoodScene();
  Body& body = scene.bodies[0];
  body.tet().materials.more = {body.material};
  body.material = NeoHookean(std::array{1e4, 0.3});
  body.tet().materials.of.assign(body.tet().mesh.tetrahedra.size(), 0);
  body.tet().materials.of[3] = 1;
  body.tet().fibres.clear();
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].fibres");
}

TEST(CheckSceneTest, PartsWithMaterialsAndActivationsThatThereAreNot) {
  const std::size_t tetrahedra = GoodScene().bodies[0].tet().mesh.tetrahedra.size();
  for (const bool of_material : {true, false}) {
    Scene scene = GoodScene();
    Body& body = scene.bodies[0];
    auto& parts = of_material ? body.tet().materials.of : body.tet().activations.of;
    const std::string path = of_material ? "bodies[0].region_materials" : "bodies[0].region_activations";
    parts.assign(tetrahedra, 0);
    Problems none;
    CheckScene(scene, none);
    EXPECT_TRUE(none.empty()) << none.ToString();
    parts[7] = 1;
    EXPECT_EQ(ProblemOf(scene).path, path);
    EXPECT_THAT(ProblemOf(scene).message, HasSubstr("element 7"));
    parts[7] = -1;
    EXPECT_EQ(ProblemOf(scene).path, path);
    parts.assign(tetrahedra - 1, 0);
    EXPECT_THAT(ProblemOf(scene).message, HasSubstr("71 entries for 72"));
  }
}

TEST(CheckSceneTest, ActivationOfAPartOutsideItsRange) {
  Scene scene = GoodScene();
  scene.bodies[0].tet().activations.more = {Curve::Constant(1), Curve::Constant(2)};
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].region_activations[1].values");
}

TEST(CheckSceneTest, ActivationScale) {
  Scene scene = GoodScene();
  std::vector<double>& scale = scene.bodies[0].tet().activation_scale;
  scale.assign(scene.bodies[0].tet().mesh.tetrahedra.size(), 0.5);
  scale[9] = 1.5;
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].activation_scale");
  EXPECT_THAT(ProblemOf(scene).message, HasSubstr("element 9"));
  scale[9] = std::nan("");
  EXPECT_THAT(ProblemOf(scene).message, HasSubstr("element 9"));
  scale[9] = 1;
  scale.pop_back();
  EXPECT_THAT(ProblemOf(scene).message, HasSubstr("71 values for 72"));
}

TEST(CheckSceneTest, InitialDisplacement) {
  Scene scene = GoodScene();
  std::vector<Vec3>& displacement = scene.bodies[0].tet().initial_displacement;
  displacement.assign(scene.bodies[0].tet().mesh.nodes.size(), Vec3(0, 0, 1e-3));
  displacement[2].y() = std::nan("");
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].initial_displacement");
  EXPECT_THAT(ProblemOf(scene).message, HasSubstr("node 2"));
  displacement[2].y() = 0;
  displacement.pop_back();
  EXPECT_THAT(ProblemOf(scene).message, HasSubstr("35 displacements for 36"));
}

TEST(CheckSceneTest, ActivationOutsideItsRange) {
  Scene scene = GoodScene();
  scene.bodies[0].activation.values[1] = 1.2;
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].activation.values");
  scene.bodies[0].activation.values[1] = -0.1;
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].activation.values");
}

TEST(CheckSceneTest, CurvesThatCannotBeEvaluated) {
  Scene scene = GoodScene();
  scene.bodies[0].loads[0].scale = {{0, 2, 2}, {0, 1, 2}, Curve::Interpolation::kLinear};
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].loads[0].scale.times");
  scene.bodies[0].loads[0].scale = {{0, 2}, {0}, Curve::Interpolation::kLinear};
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].loads[0].scale.values");
  scene.bodies[0].loads[0].scale = {{0}, {std::nan("")}, Curve::Interpolation::kLinear};
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].loads[0].scale.values");
}

// The sides x = 0 and y = 0 share an edge.
TEST(CheckSceneTest, ConstraintsThatContradictEachOther) {
  Scene scene = GoodScene();
  Constraint moving = Fix(kY0);
  scene.bodies[0].constraints.push_back(moving);  // prescribes the same: rest
  Problems problems;
  CheckScene(scene, problems);
  EXPECT_TRUE(problems.empty());

  scene.bodies[0].constraints[1].motion.translation[2] = Curve{{0, 1}, {0, 0.01}, Curve::Interpolation::kLinear};
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].constraints[1]");
  scene.bodies[0].constraints[1].axes = {true, true, false};  // z is free for the first
  problems = {};
  CheckScene(scene, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  scene.bodies[0].constraints[1].motion.rotation = Rotation{Vec3::Zero(), Vec3::UnitX(), Curve::Constant(0.1)};
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].constraints[1]");
}

TEST(CheckSceneTest, TractionNeedsSurface) {
  Scene scene = GoodScene();
  scene.bodies[0].regions[kX1].triangles.clear();
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].loads[0].region");
  scene.bodies[0].loads[0].kind = NodalForce{Vec3(0, 0, 1)};  // a force does not
  Problems problems;
  CheckScene(scene, problems);
  EXPECT_TRUE(problems.empty());
}

TEST(CheckSceneTest, RegionsThatAreNotThere) {
  Scene scene = GoodScene();
  scene.bodies[0].loads[0].region = 99;
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].loads[0].region");
  scene = GoodScene();
  scene.bodies[0].constraints[0].region = -1;
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].constraints[0].region");
}

TEST(CheckSceneTest, BodyThatWouldFlyAway) {
  Scene scene = GoodScene();
  scene.bodies[0].constraints.clear();
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].constraints");  // z alone is loaded
  scene.bodies[0].loads.clear();
  EXPECT_EQ(ProblemOf(scene).path, "bodies[0].constraints");  // gravity
  scene.gravity.acceleration.setZero();
  Problems problems;
  CheckScene(scene, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  // Balanced loads need no support.
  scene.bodies[0].loads = {{kX1, Traction{Vec3(50, 0, 0)}, Curve::Constant(1), {}},
                           {kX0, Traction{Vec3(-50, 0, 0)}, Curve::Constant(1), {}}};
  CheckScene(scene, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  scene.bodies[0].loads[1].scale = Curve{{0, 1}, {0, 1}, Curve::Interpolation::kLinear};
  EXPECT_THAT(ProblemOf(scene).message, HasSubstr("along x"));
}

// Equilibrium alone does not determine the position of an unsupported body, loaded or not.
TEST(CheckSceneTest, EquilibriumNeedsSupportsAlongEveryAxis) {
  Scene scene = GoodScene();
  scene.tet.stepping = Stepping::kQuasiStatic;
  Problems held;
  CheckScene(scene, held);
  EXPECT_TRUE(held.empty()) << held.ToString();
  scene.bodies[0].constraints[0].axes = {true, false, true};
  EXPECT_THAT(ProblemOf(scene).message, HasSubstr("along y"));
  scene.tet.stepping = Stepping::kBackwardEuler;
  CheckScene(scene, held);
  EXPECT_TRUE(held.empty()) << held.ToString();
}

TEST(CheckSceneTest, StepsThatAreSolvedForNeedDouble) {
  Scene scene = GoodScene();
  scene.tet.precision = Precision::kSingle;
  for (const Stepping stepping : {Stepping::kExplicit, Stepping::kMixed}) {
    scene.tet.stepping = stepping;
    Problems problems;
    CheckScene(scene, problems);
    EXPECT_TRUE(problems.empty()) << problems.ToString();
  }
  for (const Stepping stepping :
       {Stepping::kBackwardEuler, Stepping::kNewmark, Stepping::kBdf2, Stepping::kQuasiStatic}) {
    scene.tet.stepping = stepping;
    EXPECT_EQ(ProblemOf(scene).path, "tet.precision");
    EXPECT_THAT(ProblemOf(scene).hint, HasSubstr("explicit"));
  }
}

TEST(CheckSceneTest, Output) {
  Scene scene = GoodScene();
  scene.output.frame_interval = 1e-6;
  EXPECT_EQ(ProblemOf(scene).path, "output.frame_interval");
  scene = GoodScene();
  scene.output.probes.push_back({"tip", 0, 4});
  EXPECT_EQ(ProblemOf(scene).path, "output.probes[1].name");
  scene.output.probes[1] = {"other", 0, 1000000};
  EXPECT_EQ(ProblemOf(scene).path, "output.probes[1].point");
  scene.output.probes[1] = {"other", 3, 0};
  EXPECT_EQ(ProblemOf(scene).path, "output.probes[1].body");
  scene = GoodScene();
  scene.output.moments = {{0, kX0}, {0, kX1}};
  EXPECT_EQ(ProblemOf(scene).path, "output.moments[1].region");
  scene.output.moments = {{0, kX0}, {0, kX0}};
  EXPECT_EQ(ProblemOf(scene).path, "output.moments[1].region");
  scene.output.moments = {{3, kX0}};
  EXPECT_EQ(ProblemOf(scene).path, "output.moments[0].body");
}

TEST(CheckSceneTest, FieldsThatNoBodyCanGive) {
  Scene scene = GoodScene();
  scene.output.fields = {OutputField::kVelocity, OutputField::kFibreStretch};
  Problems none;
  CheckScene(scene, none);
  EXPECT_TRUE(none.empty()) << none.ToString();
  scene.output.fields.push_back(OutputField::kVelocity);
  EXPECT_EQ(ProblemOf(scene).path, "output.fields[2]");
  scene.output.fields.pop_back();
  scene.bodies[0].material = NeoHookean(std::array{1e4, 0.3});
  scene.bodies[0].tet().fibres.clear();
  EXPECT_EQ(ProblemOf(scene).path, "output.fields[1]");
  EXPECT_THAT(ProblemOf(scene).message, HasSubstr("no body has fibres"));
}

TEST(CheckSceneTest, BodiesHaveTheShapeOfTheMethod) {
  for (const Method method : {Method::kVoxel, Method::kEulerian}) {
    Scene scene = GoodScene();
    scene.method = method;
    Problems problems;
    CheckScene(scene, problems);
    EXPECT_TRUE(std::any_of(problems.kept().begin(), problems.kept().end(), [](const Problem& problem) {
      return problem.path == "bodies[0].mesh";
    })) << problems.ToString();
  }
}

RigidBody BallAt(const Vec3& place) { return {"ball", Ball{0.01}, {place, {1, 0, 0, 0}}, {}, {}, "", 0, {}}; }

// The paths of a scene's problems, beside that the method refuses rigid bodies.
std::vector<std::string> PathsOf(const Scene& scene) {
  Problems problems;
  CheckScene(scene, problems);
  std::vector<std::string> paths;
  for (const Problem& problem : problems.kept()) {
    if (problem.message.find("does not support") == std::string::npos) paths.push_back(problem.path);
  }
  return paths;
}

TEST(CheckSceneTest, RigidBodiesAndContacts) {
  using ::testing::ElementsAre;
  Scene scene = GoodScene();
  scene.rigid_bodies = {BallAt(Vec3(0.015, 0.01, -0.011))};
  EXPECT_THAT(PathsOf(scene), ElementsAre());
  const Scene good = scene;
  RigidBody& ball = scene.rigid_bodies[0];
  ball.pose.position[2] = 0;
  EXPECT_THAT(PathsOf(scene), ElementsAre("rigid_bodies[0]")) << "starts inside of the body";
  ball.bodies = {1};
  EXPECT_THAT(PathsOf(scene), ElementsAre("rigid_bodies[0].bodies"));
  scene = good;
  ball.shape = Ball{-1};
  EXPECT_THAT(PathsOf(scene), ElementsAre("rigid_bodies[0]"));
  scene = good;
  ball.bone = "humerus";
  EXPECT_THAT(PathsOf(scene), ElementsAre("rigid_bodies[0].bone"));
  scene = good;
  ball.motion = Motion();
  ball.motion->translation[0] = Curve{{0, 1}, {0.1, 0}};
  EXPECT_THAT(PathsOf(scene), ElementsAre("rigid_bodies[0].motion")) << "does not begin at its pose";
  ball.motion->translation[0] = Curve{{0, 1}, {0, 0.1}};
  EXPECT_THAT(PathsOf(scene), ElementsAre());
  ball.free = FreeRigidMotion{{}, {}, Vec3::Zero(), Vec3::Zero()};
  EXPECT_THAT(PathsOf(scene), ElementsAre("rigid_bodies[0]", "rigid_bodies[0].free")) << "two motions, no mass";
  scene = good;
  scene.floors = {{"ball", Vec3(0, 0, -1), Vec3::UnitZ()}};
  EXPECT_THAT(PathsOf(scene), ElementsAre("rigid_bodies[0].name"));
  scene = good;
  scene.contacts = {{}};
  EXPECT_THAT(PathsOf(scene), ElementsAre("contacts")) << "of another method";
}

// A plastic cube of the eulerian method, compressed.
Scene PlasticScene() {
  Scene scene = FullScene(Method::kEulerian, FullSurfaceShape());
  scene.floors.clear();
  scene.rigid_bodies.clear();
  scene.contacts.clear();
  scene.bodies[0].viscoelasticity = {};
  scene.bodies[0].regions.resize(1);
  scene.bodies[0].regions[0].selectors = {PlaneSelector{Vec3::Zero(), -Vec3::UnitX()}};
  return scene;
}

TEST(CheckSceneTest, NumbersOfPlasticity) {
  Scene scene = PlasticScene();
  Problems none;
  CheckScene(scene, none);
  EXPECT_TRUE(none.empty()) << none.ToString();
  Plasticity& plasticity = *scene.bodies[0].surface().plasticity;
  for (const double wrong : {0.0, -1.0, std::nan("")}) {
    plasticity = {wrong, 0};
    EXPECT_EQ(ProblemOf(scene).path, "bodies[0].plasticity.yield_stress") << wrong;
  }
  for (const double wrong : {-1.0, double{INFINITY}, std::nan("")}) {
    plasticity = {1, wrong};
    EXPECT_EQ(ProblemOf(scene).path, "bodies[0].plasticity.relaxation_time") << wrong;
  }
}

TEST(CheckSceneTest, NumbersOfPlaneForceFields) {
  const Scene good = PlasticScene();
  Scene scene = good;
  scene.squeezes[0].normal *= 2;
  EXPECT_EQ(ProblemOf(scene).path, "squeezes[0]");
  scene = good;
  scene.squeezes[0].point.x() = std::nan("");
  EXPECT_EQ(ProblemOf(scene).path, "squeezes[0]");
  scene = good;
  scene.squeezes[0].force_density = INFINITY;
  EXPECT_EQ(ProblemOf(scene).path, "squeezes[0].force_density");
  scene = good;
  scene.squeezes[0].width = -1;
  EXPECT_EQ(ProblemOf(scene).path, "squeezes[0].width");
  scene = good;
  scene.squeezes[0].scale.values[0] = std::nan("");
  EXPECT_EQ(ProblemOf(scene).path, "squeezes[0].scale.values");
}

TEST(CheckSceneTest, AllProblemsAtOnce) {
  Scene scene = GoodScene();
  scene.bodies[0].density = -1;
  scene.bodies[0].activation.values[0] = 7;
  scene.duration = 0;
  Problems problems;
  CheckScene(scene, problems);
  EXPECT_EQ(problems.count(), 3u);
}

}  // namespace
}  // namespace fascicle
