// The state at time 0: initial displacements and velocities from files, and frames of other jobs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/mesh_edges.h"
#include "core/sim/simulation.h"
#include "core/tet/model.h"
#include "scenes.h"

namespace fascicle::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// One tetrahedron of ten nodes in Gmsh's order, whose edge from 1 to 2 is curved. A mid-edge node is the first of all.
const char kTenNodes[] = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
10
1 5 0 0
2 0 0 0
3 10 0 0
4 0 10 0
5 0 0 10
6 6 6 0
7 0 5 0
8 0 0 5
9 0 5 5
10 5 0 5
$EndNodes
$Elements
1
1 11 2 7 7 2 3 4 5 1 6 7 8 9 10
$EndElements
)";

void SetFile(const std::string& asset, v1::FileRef& file) {
  file.set_path("values.txt");
  file.set_asset(asset);
}

v1::Scene TenNodeScene(Files& files, const std::string& displacement, const std::string& velocity) {
  v1::Scene scene = ParseText(R"(
    name: "one" duration: 1 tet { stepping: STEPPING_NEWMARK } output { frame_interval: 0.1 }
    bodies {
      name: "one" unit: LENGTH_UNIT_CM mesh { file { path: "one.msh" } }
      material { neo_hookean { young_modulus: 1e4 } }
    })");
  v1::Body& body = *scene.mutable_bodies(0);
  body.mutable_mesh()->mutable_file()->set_asset(files.Add(kTenNodes));
  if (!displacement.empty()) SetFile(files.Add(displacement), *body.mutable_initial_displacement());
  if (!velocity.empty()) SetFile(files.Add(velocity), *body.mutable_initial_velocity());
  return scene;
}

// Line k is "k 0 0".
std::string Lines(int count) {
  std::string lines;
  for (int k = 1; k <= count; ++k) lines += std::to_string(k) + " 0 0\n";
  return lines;
}

std::vector<double> FirstComponents(const std::vector<Vec3>& values) {
  std::vector<double> first;
  for (const Vec3& value : values) first.push_back(value.x());
  return first;
}

// Corners have the file's numbers 2 to 5; edges are counted as the tetrahedron has them: 01 12 02 03 13 23.
TEST(InitialState, HasALineForEachNodeOfAMeshOfSecondOrder) {
  Files files;
  const auto scene = Translate(TenNodeScene(files, Lines(10), Lines(10)), files);
  ASSERT_NE(scene, nullptr);
  const TetShape& shape = scene->bodies[0].tet();
  EXPECT_THAT(FirstComponents(shape.initial_velocity), ElementsAre(2, 3, 4, 5, 1, 6, 7, 8, 10, 9));
  ASSERT_EQ(shape.initial_displacement.size(), 10u);
  EXPECT_DOUBLE_EQ(shape.initial_displacement[0].x(), 0.02) << "in the body's unit, cm";
  EXPECT_DOUBLE_EQ(shape.initial_displacement[4].x(), 0.01);
  EXPECT_TRUE(scene->bodies[0].notes.empty());
}

TEST(InitialState, OfCornersOnlyIsInterpolatedAndSaysSo) {
  Files files;
  const auto scene = Translate(TenNodeScene(files, Lines(4), ""), files);
  ASSERT_NE(scene, nullptr);
  EXPECT_EQ(scene->bodies[0].tet().initial_displacement.size(), 4u);
  ASSERT_EQ(scene->bodies[0].notes.size(), 1u);
  EXPECT_THAT(scene->bodies[0].notes[0], HasSubstr("bodies[0].initial_displacement: has values of corners only"));
}

TEST(InitialState, OfMidEdgeNodesHasNoEffectOnLinearElements) {
  Files files;
  v1::Scene wire = TenNodeScene(files, "", Lines(10));
  wire.mutable_tet()->set_element(v1::ELEMENT_LINEAR);
  const auto scene = Translate(wire, files);
  ASSERT_NE(scene, nullptr);
  EXPECT_THAT(FirstComponents(scene->bodies[0].tet().initial_velocity), ElementsAre(2, 3, 4, 5));
  EXPECT_THAT(scene->bodies[0].notes.back() + scene->bodies[0].notes.front(),
              HasSubstr("values of mid-edge nodes have no effect"));
}

TEST(InitialState, OfAnotherNumberOfNodesIsRefused) {
  Files files;
  const Problems problems = ProblemsOf(TenNodeScene(files, Lines(5), ""), files);
  EXPECT_THAT(At(problems, "bodies[0].initial_displacement"),
              HasSubstr("5 lines for 4 corners, or 10 nodes of the file"));
}

// Without mid-edge nodes of the file, lines may follow the order of frames and exported files.
TEST(InitialState, OfABuiltInShapeMayHaveMidEdgeNodesLast) {
  Files files;
  v1::Scene wire = BoxScene();
  wire.mutable_tet()->set_stepping(v1::STEPPING_BDF2);
  const std::size_t nodes = 60, edges = NumberEdges(Translate(wire, files)->bodies[0].tet().mesh).ends.size();
  SetFile(files.Add(Lines(static_cast<int>(nodes + edges))), *wire.mutable_bodies(0)->mutable_initial_velocity());
  const auto scene = Translate(wire, files);
  ASSERT_NE(scene, nullptr);
  EXPECT_EQ(scene->bodies[0].tet().initial_velocity.size(), nodes + edges);
}

TEST(InitialState, VelocitiesHaveNoEffectWithoutInertia) {
  Files files;
  v1::Scene wire = BoxScene();
  SetFile(files.Add(Lines(60)), *wire.mutable_bodies(0)->mutable_initial_velocity());
  wire.mutable_start()->mutable_equilibrium();
  EXPECT_THAT(At(ProblemsOf(wire, files), "bodies[0].initial_velocity"), HasSubstr("has no effect"));
  wire.clear_start();
  wire.mutable_tet()->set_stepping(v1::STEPPING_QUASI_STATIC);
  const auto scene = Translate(wire, files);
  ASSERT_NE(scene, nullptr);
  EXPECT_THAT(scene->bodies[0].notes.back(), HasSubstr("bodies[0].initial_velocity: has no effect"));
}

// A frame of the scene in which every node, mid-edge nodes too, is displaced by (1, 2, 3) mm.
v1::FrameState StateOf(const std::shared_ptr<const Scene>& scene, bool velocity) {
  Simulation simulation(scene, 1);
  v1::FrameState state;
  *state.mutable_geometry() = EncodeGeometry(*scene, simulation.layout());
  Frame frame;
  frame.index = 7;
  frame.time = 0.7;
  BodyFrame& body = frame.bodies.emplace_back();
  for (const Vec3& X : scene->bodies[0].nodes()) body.positions.emplace_back(X + Vec3(1e-3, 2e-3, 3e-3));
  std::size_t nodes = body.positions.size();
  if (!simulation.layout().higher_order.empty()) {
    for (const Vec3& X : simulation.layout().higher_order[0].positions) {
      body.higher_order_positions.emplace_back(X + Vec3(1e-3, 2e-3, 3e-3));
    }
    nodes += body.higher_order_positions.size();
  }
  if (velocity) {
    body.fields.push_back(FieldOf(OutputField::kVelocity, FieldLocation::kNode, std::vector<double>(180, 0.5)));
    if (nodes > 60) body.fields[0].all_values.assign(3 * nodes, 0.5);
  }
  *state.mutable_frame() = EncodeFrame(frame);
  return state;
}

v1::Scene StartsFrom(v1::Scene wire, const v1::FrameState& state, Files& files) {
  v1::FrameStart& start = *wire.mutable_start()->mutable_frame();
  start.set_job("jobs/source");
  start.mutable_state()->set_asset(files.Add(state.SerializeAsString()));
  return wire;
}

class FrameStartTest : public ::testing::TestWithParam<v1::Element> {
 protected:
  v1::Scene Wire() const {
    v1::Scene wire = BoxScene();
    wire.mutable_tet()->set_element(GetParam());
    return wire;
  }
};

TEST_P(FrameStartTest, PutsAllNodesWhereTheyWere) {
  Files files;
  const v1::FrameState state = StateOf(Translate(Wire()), true);
  const auto scene = Translate(StartsFrom(Wire(), state, files), files);
  ASSERT_NE(scene, nullptr);
  EXPECT_TRUE(scene->start.frame);
  const TetModel model(*scene);
  const NodalVector x = model.InitialPositions(), v = model.InitialVelocities();
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    EXPECT_NEAR((x[n] - model.rest_positions()[n] - Vec3(1e-3, 2e-3, 3e-3)).norm(), 0, 1e-16);
    EXPECT_EQ(v[n], Vec3(0.5, 0.5, 0.5));
  }
  EXPECT_EQ(scene->bodies[0].notes.back(), "start.frame: begins as frame 7 (0.7 s) of jobs/source");
}

TEST_P(FrameStartTest, IsAtRestWithoutVelocitiesAndSaysSo) {
  Files files;
  const auto scene = Translate(StartsFrom(Wire(), StateOf(Translate(Wire()), false), files), files);
  ASSERT_NE(scene, nullptr);
  EXPECT_TRUE(scene->bodies[0].tet().initial_velocity.empty());
  EXPECT_THAT(scene->bodies[0].notes.back(), HasSubstr("at rest, since it has no velocities"));
}

TEST_P(FrameStartTest, RefusesOtherBodiesMeshesAndElements) {
  Files files;
  const v1::FrameState state = StateOf(Translate(Wire()), true);
  v1::Scene other = Wire();
  other.mutable_bodies(0)->set_name("cube");
  EXPECT_THAT(At(ProblemsOf(StartsFrom(other, state, files), files), "start.frame"), HasSubstr("body `box`"));
  other = Wire();
  other.mutable_bodies(0)->mutable_mesh()->mutable_box()->set_divisions(0, 3);
  EXPECT_THAT(At(ProblemsOf(StartsFrom(other, state, files), files), "start.frame"), HasSubstr("another mesh"));
  other = Wire();
  other.mutable_bodies(0)->mutable_mesh()->mutable_box()->set_size(0, 2.001);
  EXPECT_THAT(At(ProblemsOf(StartsFrom(other, state, files), files), "start.frame"), HasSubstr("another mesh"));
  other = Wire();
  *other.add_bodies() = other.bodies(0);
  other.mutable_bodies(1)->set_name("second");
  EXPECT_THAT(At(ProblemsOf(StartsFrom(other, state, files), files), "start.frame"),
              HasSubstr("has 1 bodies, where this scene has 2"));
  other = Wire();
  other.mutable_tet()->set_element(GetParam() == v1::ELEMENT_QUADRATIC ? v1::ELEMENT_LINEAR : v1::ELEMENT_QUADRATIC);
  EXPECT_THAT(At(ProblemsOf(StartsFrom(other, state, files), files), "start.frame"),
              HasSubstr(GetParam() == v1::ELEMENT_QUADRATIC ? "other mid-edge nodes"
                        : GetParam() == v1::ELEMENT_LINEAR  ? "corner nodes of `box` only"
                                                            : "another mesh"));
}
INSTANTIATE_TEST_SUITE_P(Elements, FrameStartTest,
                         ::testing::Values(v1::ELEMENT_LINEAR, v1::ELEMENT_QUADRATIC, v1::ELEMENT_HEXAHEDRAL));

TEST(StartInput, EveryMistakeIsToldAtOnce) {
  Files files;
  v1::Scene wire = BoxScene();
  wire.mutable_start()->mutable_frame()->set_frame(2);
  SetFile(files.Add(Lines(60)), *wire.mutable_bodies(0)->mutable_initial_velocity());
  const Problems problems = ProblemsOf(wire, files);
  EXPECT_THAT(At(problems, "start.frame.job"), HasSubstr("is missing"));
  wire.mutable_start()->mutable_frame()->mutable_state()->set_asset(files.Add("no frame at all"));
  EXPECT_THAT(At(ProblemsOf(wire, files), "start.frame.state"), HasSubstr("is not a frame"));
  EXPECT_THAT(At(ProblemsOf(wire, files), "bodies[0].initial_velocity"), HasSubstr("beside start.frame"));
  wire = BoxScene();
  wire.mutable_start();
  EXPECT_FALSE(ProblemsOf(wire).empty()) << "a start without a kind";
  wire.mutable_start()->mutable_equilibrium();
  wire.mutable_bodies(0)->clear_constraints();
  EXPECT_THAT(At(ProblemsOf(wire), "bodies[0].constraints"), HasSubstr("no support holds the body"));
}

TEST(StartInput, OtherMethodsHaveNone) {
  v1::Scene wire = ParseText(R"(
    name: "voxels" duration: 1 voxel { stepping: VOXEL_STEPPING_DYNAMIC } output { frame_interval: 0.1 }
    start { equilibrium {} }
    bodies {
      name: "box" mesh { box { size: [1, 1, 1] divisions: [2, 2, 2] } }
      material { linear_elastic { young_modulus: 1e4 } }
    })");
  EXPECT_THAT(At(ProblemsOf(wire), "start"), HasSubstr("the voxel method does not support it"));
}

}  // namespace
}  // namespace fascicle::server
