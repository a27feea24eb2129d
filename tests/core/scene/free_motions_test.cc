#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/free_motions.h"
#include "core/scene/scene.h"
#include "tests/support/tet_scenes.h"

namespace fascicle {
namespace {

using namespace fascicle::testing;
using ::testing::HasSubstr;

// A box of 40 x 20 x 10 mm whose only region is `held`.
Body BoxHeldAt(const Selector& selector, std::array<bool, 3> axes = {true, true, true}) {
  Body body = BoxBody(Vec3(0.04, 0.02, 0.01), {4, 2, 1}, NeoHookean(std::array{1e4, 0.3}));
  const std::vector<Triangle> surface = BoundaryTriangles(body.tet().mesh);
  body.regions = {SelectRegion(body.tet().mesh, surface, "held", selector)};
  Constraint constraint;
  constraint.region = 0;
  constraint.axes = axes;
  body.constraints = {constraint};
  return body;
}

std::string MotionsOf(const Body& body) {
  const std::vector<FreePart> free = FindFreeParts(body);
  return free.empty() ? "none" : free[0].motions;
}

TEST(FreeMotionsTest, AHeldFaceLeavesNone) {
  EXPECT_EQ(MotionsOf(BoxHeldAt(PlaneSelector{Vec3::Zero(), -Vec3::UnitX()})), "none");
}

TEST(FreeMotionsTest, AHeldPointIsABallJoint) {
  EXPECT_EQ(MotionsOf(BoxHeldAt(SphereSelector{Vec3(0.04, 0.02, 0), 1e-6})), "turns about the point [0.04, 0.02, 0] m");
}

TEST(FreeMotionsTest, AHeldEdgeIsAHinge) {
  EXPECT_EQ(MotionsOf(BoxHeldAt(BoxSelector{Vec3(0.039, -1, -1), Vec3(0.041, 1, 0.001)})),
            "turns about the line through [0.04, 0.01, 0] m along y");
}

TEST(FreeMotionsTest, ARollerSlidesAndTurns) {
  EXPECT_EQ(MotionsOf(BoxHeldAt(PlaneSelector{Vec3::Zero(), -Vec3::UnitZ()}, {false, false, true})),
            "moves along x and y, turns about z");
}

TEST(FreeMotionsTest, WithoutSupportsAllAreFree) {
  Body body = BoxHeldAt(SphereSelector{Vec3::Zero(), 1e-6});
  body.constraints.clear();
  EXPECT_EQ(MotionsOf(body), "moves along x, y and z, turns about x, y and z");
}

// Three rollers of which none holds a rotation alone.
TEST(FreeMotionsTest, SymmetryPlanesHold) {
  Body body = BoxBody(Vec3(0.04, 0.02, 0.01), {4, 2, 1}, NeoHookean(std::array{1e4, 0.3}));
  for (const auto& [region, axis] : {std::pair{kX0, 0}, {kY0, 1}, {kZ0, 2}}) {
    Constraint roller;
    roller.region = region;
    roller.axes = {axis == 0, axis == 1, axis == 2};
    body.constraints.push_back(roller);
  }
  EXPECT_EQ(MotionsOf(body), "none");
}

// Two boxes in one body, of which one is held.
TEST(FreeMotionsTest, APartWithoutSupport) {
  Body body = BoxHeldAt(PlaneSelector{Vec3::Zero(), -Vec3::UnitX()});
  TetMesh& mesh = body.tet().mesh;
  const auto nodes = static_cast<std::int32_t>(mesh.nodes.size());
  const std::size_t tetrahedra = mesh.tetrahedra.size();
  for (std::int32_t n = 0; n < nodes; ++n) mesh.nodes.push_back(mesh.nodes[n] + Vec3(0.1, 0, 0));
  for (std::size_t t = 0; t < tetrahedra; ++t) {
    Tetrahedron copy = mesh.tetrahedra[t];
    for (std::int32_t& n : copy) n += nodes;
    mesh.tetrahedra.push_back(copy);
  }
  const std::vector<FreePart> free = FindFreeParts(body);
  ASSERT_EQ(free.size(), 1u);
  EXPECT_EQ(free[0].tetrahedra, tetrahedra);
  EXPECT_EQ(free[0].parts, 2u);
  EXPECT_THAT(free[0].motions, HasSubstr("moves along x, y and z"));
}

// Only a stepping without inertia needs supports.
TEST(FreeMotionsTest, RefusedBeforeAQuasiStaticRun) {
  Scene scene = OneBody(BoxHeldAt(SphereSelector{Vec3::Zero(), 1e-6}));
  scene.tet.stepping = Stepping::kQuasiStatic;
  Problems problems;
  CheckScene(scene, problems);
  ASSERT_EQ(problems.count(), 1u) << problems.ToString();
  EXPECT_EQ(problems.kept()[0].path, "bodies[0].constraints");
  EXPECT_EQ(problems.kept()[0].message, "the supports leave the body free: it turns about the point [0, 0, 0] m");
  scene.tet.stepping = Stepping::kBackwardEuler;
  Problems none;
  CheckScene(scene, none);
  EXPECT_TRUE(none.empty()) << none.ToString();
}

}  // namespace
}  // namespace fascicle
