// Valid scenes: everything reaches the core, in SI units and with defaults.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/shapes.h"
#include "core/scene/output_fields.h"
#include "proto/rules/enum_names.h"
#include "scenes.h"

namespace fascicle::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// The material of each tetrahedron of a box of 2 x 3 x 4 hexahedra, x fastest, six tetrahedra each.
const Material& MaterialOf(const Body& body, std::size_t tetrahedron) {
  const std::int32_t part = body.tet().materials.of[tetrahedron];
  return part == 0 ? body.material : body.tet().materials.more[static_cast<std::size_t>(part - 1)];
}

TEST(TranslateScene, ConvertsLengthsOfABody) {
  v1::Scene wire = BoxScene();
  v1::Body& body = *wire.mutable_bodies(0);
  v1::Motion& motion = *body.mutable_constraints(0)->mutable_motion();
  google::protobuf::TextFormat::ParseFromString(R"(
    rotation { point: [1, 2, 3] axis: [0, 0, 2] angle { times: 0 times: 1 values: 0 values: 0.5 } }
    translation { axis: AXIS_Y curve { times: [0, 1] values: [0, 0.25] interpolation: INTERPOLATION_SMOOTH } })",
                                                &motion);
  v1::Probe& probe = *wire.mutable_output()->add_probes();
  google::protobuf::TextFormat::ParseFromString(R"(name: "p" body: "box" point: [2.1, 3, 4.2])", &probe);
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  const Body& box = scene->bodies[0];
  EXPECT_EQ(box.tet().mesh.nodes.size(), 3u * 4u * 5u);
  EXPECT_EQ(box.tet().mesh.tetrahedra.size(), 6u * 2u * 3u * 4u);
  EXPECT_NEAR(TotalVolume(box.tet().mesh), 24e-6, 1e-18);
  ASSERT_EQ(box.regions.size(), 2u);
  EXPECT_EQ(box.regions[0].nodes.size(), 12u);
  EXPECT_EQ(box.regions[1].triangles.size(), 12u);
  const Constraint& constraint = box.constraints[0];
  ASSERT_TRUE(constraint.motion.rotation.has_value());
  EXPECT_LT((constraint.motion.rotation->point - Vec3(0.01, 0.02, 0.03)).norm(), 1e-17);
  EXPECT_EQ(constraint.motion.rotation->axis, Vec3::UnitZ());
  EXPECT_EQ(constraint.motion.rotation->angle.values, std::vector<double>({0, 0.5}));
  ASSERT_TRUE(constraint.motion.translation[1].has_value());
  // Motions are in metres, independently of the body's unit.
  EXPECT_EQ(constraint.motion.translation[1]->values, std::vector<double>({0, 0.25}));
  EXPECT_EQ(constraint.motion.translation[1]->interpolation, Curve::Interpolation::kSmooth);
  EXPECT_FALSE(constraint.motion.translation[0].has_value());
  ASSERT_EQ(scene->output.probes.size(), 1u);
  EXPECT_EQ(box.tet().mesh.nodes[static_cast<std::size_t>(scene->output.probes[0].node)], Vec3(0.02, 0.03, 0.04));
}

TEST(TranslateScene, PlacesProbesAndMoments) {
  v1::Scene wire = BoxScene();
  google::protobuf::TextFormat::ParseFromString(R"(
    probes { name: "inside" body: "box" point: [1.1, 1.2, 1.3] }
    probes { name: "outside" body: "box" point: [1.1, 1.2, -0.5] }
    moments { body: "box" region: "bottom" point: [1, 2, 3] axis: [0, 0, 2] }
    line_of_action: [0, 3, 0] frame_interval: 0.1)",
                                                wire.mutable_output());
  wire.mutable_output()->mutable_moments(0)->set_region(wire.bodies(0).constraints(0).region());
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  const Output& output = scene->output;
  ASSERT_EQ(output.probes.size(), 2u);
  EXPECT_TRUE(output.probes[0].inside.has_value());
  EXPECT_FALSE(output.probes[1].inside.has_value());
  EXPECT_THAT(scene->bodies[0].notes, ElementsAre(testing::HasSubstr("output.probes[1].point: is outside")));
  ASSERT_EQ(output.moments.size(), 1u);
  EXPECT_LT((output.moments[0].point.value() - Vec3(0.01, 0.02, 0.03)).norm(), 1e-17);
  EXPECT_EQ(output.moments[0].axis, Vec3::UnitZ());
  EXPECT_EQ(output.line_of_action, Vec3::UnitY());
}

// Each field without effect is a note; those with one are not.
TEST(TranslateScene, FieldsWithoutEffectAreNotes) {
  v1::Scene wire = BoxScene();
  google::protobuf::TextFormat::ParseFromString("viscosity: 10 mass_proportional: 0",
                                                wire.mutable_bodies(0)->mutable_damping());
  google::protobuf::TextFormat::ParseFromString("stepping: STEPPING_QUASI_STATIC safety: 0.5 newton_tolerance: 1e-6",
                                                wire.mutable_tet());
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  EXPECT_THAT(scene->bodies[0].notes, ElementsAre(testing::HasSubstr("tet.safety: has no effect"),
                                                  testing::HasSubstr("bodies[0].damping.viscosity: has no effect")));
  wire.mutable_tet()->set_stepping(v1::STEPPING_EXPLICIT);
  EXPECT_THAT(Translate(wire)->bodies[0].notes, ElementsAre(testing::HasSubstr("tet.newton_tolerance: has no effect")));
}

TEST(TranslateScene, TakesDefaultsFromTheRules) {
  const auto scene = Translate(BoxScene());
  ASSERT_NE(scene, nullptr);
  EXPECT_EQ(scene->bodies[0].density, 1060);
  EXPECT_EQ(scene->tet.stepping, Stepping::kExplicit);
  EXPECT_FALSE(scene->tet.time_step.has_value());
  EXPECT_EQ(scene->tet.safety, 0.9);
  EXPECT_EQ(scene->tet.solver_tolerance, 1e-8);
  EXPECT_EQ(scene->bodies[0].activation.values, std::vector<double>({0}));
  EXPECT_EQ(scene->gravity.acceleration, Vec3::Zero());
  EXPECT_FALSE(scene->output.settle_speed.has_value());
  EXPECT_EQ(scene->bodies[0].constraints[0].axes, (std::array<bool, 3>{true, true, true}));
}

// Fields of the wire format and computed fields correspond one to one.
TEST(TranslateScene, KnowsAllOutputFields) {
  const auto& fields = *v1::Field_descriptor();
  ASSERT_EQ(static_cast<std::size_t>(fields.value_count()), OutputFields().size() + 1);
  for (int i = 1; i < fields.value_count(); ++i) {
    v1::Scene wire = BoxScene();
    ASSERT_TRUE(google::protobuf::TextFormat::MergeFromString("fibres { constant { direction: [1, 0, 0] } }",
                                                              wire.mutable_bodies(0)));
    wire.mutable_output()->add_fields(static_cast<v1::Field>(fields.value(i)->number()));
    for (const double component : {0, 0, 1}) wire.mutable_output()->add_line_of_action(component);
    const auto scene = Translate(wire);
    ASSERT_NE(scene, nullptr) << fields.value(i)->name();
    EXPECT_EQ(InfoOf(scene->output.fields[0]).name, NameOf(*fields.value(i)));
  }
}

TEST(TranslateScene, CarriesEverythingElse) {
  v1::Scene wire = BoxScene();
  google::protobuf::TextFormat::MergeFromString(R"(
    gravity { acceleration: [0, 0, -9.81] scale { times: 0 values: 0.5 } }
    tet { stepping: STEPPING_MIXED time_step: 1e-4 safety: 0.5 solver_tolerance: 1e-6 }
    output { fields: FIELD_VELOCITY fields: FIELD_CAUCHY_STRESS settle_speed: 1e-3 })",
                                                &wire);
  google::protobuf::TextFormat::MergeFromString(R"(
    density: 1000
    damping { mass_proportional: 1 stiffness_proportional: 2 viscosity: 3 }
    constraints { region: "top" axes: AXIS_X axes: AXIS_Z }
    loads { region: "top" traction { vector: [1, 2, 3] } scale { times: [0, 1] values: [0, 1] } }
    loads { region: "top" nodal_force { total: [4, 5, 6] } })",
                                                wire.mutable_bodies(0));
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  EXPECT_EQ(scene->name, "box");
  EXPECT_EQ(scene->duration, 1);
  EXPECT_EQ(scene->gravity.acceleration, Vec3(0, 0, -9.81));
  EXPECT_EQ(scene->gravity.scale.values, std::vector<double>({0.5}));
  EXPECT_EQ(scene->tet.stepping, Stepping::kMixed);
  EXPECT_EQ(scene->tet.time_step, 1e-4);
  EXPECT_EQ(scene->tet.safety, 0.5);
  EXPECT_EQ(scene->tet.solver_tolerance, 1e-6);
  EXPECT_THAT(scene->output.fields, ElementsAre(OutputField::kVelocity, OutputField::kCauchyStress));
  EXPECT_EQ(scene->output.settle_speed, 1e-3);
  const Body& body = scene->bodies[0];
  EXPECT_EQ(body.density, 1000);
  EXPECT_EQ(body.damping.mass_proportional, 1);
  EXPECT_EQ(body.damping.stiffness_proportional, 2);
  EXPECT_EQ(body.damping.viscosity, 3);
  EXPECT_EQ(body.constraints[1].axes, (std::array<bool, 3>{true, false, true}));
  ASSERT_EQ(body.loads.size(), 2u);
  EXPECT_EQ(body.loads[0].region, 1);
  EXPECT_EQ(std::get<Traction>(body.loads[0].kind).vector, Vec3(1, 2, 3));
  EXPECT_EQ(body.loads[0].scale.values, std::vector<double>({0, 1}));
  EXPECT_EQ(std::get<NodalForce>(body.loads[1].kind).total, Vec3(4, 5, 6));
}

TEST(TranslateScene, LoadsThatDependOnPositions) {
  v1::Scene wire = BoxScene();
  *wire.add_bodies() = wire.bodies(0);
  wire.mutable_bodies(1)->set_name("other");
  google::protobuf::TextFormat::MergeFromString(R"(
    loads { region: "top" pressure { value: 5e3 } scale { times: [0, 1] values: [0, 1] } }
    loads { region: "top" springs { stiffness: [0, 0, 20] } }
    loads { region: "bottom" line_spring { region: "top" stiffness: 30 rest_length: 0.01 } }
    loads { region: "top" line_spring { body: "other" region: "bottom" stiffness: 40 tension_only: true } })",
                                                wire.mutable_bodies(0));
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  const std::vector<Load>& loads = scene->bodies[0].loads;
  ASSERT_EQ(loads.size(), 4u);
  EXPECT_EQ(std::get<Pressure>(loads[0].kind).value, 5e3);
  EXPECT_EQ(std::get<Springs>(loads[1].kind).stiffness, Vec3(0, 0, 20));
  const auto& own = std::get<LineSpring>(loads[2].kind);
  EXPECT_EQ(std::pair(own.body, own.region), (std::pair<std::int32_t, std::int32_t>{0, 1}));
  EXPECT_EQ(own.rest_length, 0.01);
  EXPECT_FALSE(own.tension_only);
  const auto& other = std::get<LineSpring>(loads[3].kind);
  EXPECT_EQ(std::pair(other.body, other.region), (std::pair<std::int32_t, std::int32_t>{1, 0}));
  EXPECT_FALSE(other.rest_length.has_value());
  EXPECT_TRUE(other.tension_only);
}

TEST(TranslateScene, LoadsThatCanNotAct) {
  const auto with = [](const std::string& loads, const std::string& rest = "") {
    v1::Scene wire = BoxScene();
    google::protobuf::TextFormat::MergeFromString(loads, wire.mutable_bodies(0));
    google::protobuf::TextFormat::MergeFromString(rest, &wire);
    return ProblemsOf(wire);
  };
  const std::string path = "bodies[0].loads[0]";
  EXPECT_THAT(At(with(R"(loads { region: "top" body_force { density: [1, 0, 0] } })"), path + ".region"),
              HasSubstr("needs elements, but region `top` contains none"));
  EXPECT_THAT(At(with(R"(loads { region: "top" springs { stiffness: [0, 0, 0] } })"), path + ".springs.stiffness"),
              HasSubstr("one above"));
  EXPECT_THAT(At(with(R"(loads { region: "top" springs { stiffness: [0, 0, 9] } scale { times: 0 values: -1 } })"),
                 path + ".scale"),
              HasSubstr("negative stiffness"));
  EXPECT_THAT(
      At(with(R"(loads { region: "top" line_spring { region: "botom" stiffness: 1 } })"), path + ".line_spring.region"),
      HasSubstr("bottom"));
  EXPECT_THAT(
      At(with(R"(loads { region: "top" line_spring { region: "top" stiffness: 1 } })"), path + ".line_spring.region"),
      HasSubstr("the same region"));
  EXPECT_THAT(
      At(with(R"(loads { region: "top" pressure { value: 1 } })", "eulerian { cell_size: 0.004 }"), path + ".pressure"),
      HasSubstr("the eulerian method has"));
}

TEST(TranslateScene, SteppingChoosesTheElementUnlessTheSceneDoes) {
  v1::Scene wire = BoxScene();
  const auto method = [&] {
    const auto scene = Translate(wire);
    EXPECT_NE(scene, nullptr);
    return scene ? scene->tet : TetMethod{};
  };
  EXPECT_EQ(method().element, ElementOrder::kLinear);
  EXPECT_EQ(method().volume, VolumeForm::kNodal);
  EXPECT_EQ(method().newton_tolerance, 1e-8);
  const std::pair<v1::Stepping, Stepping> solved[] = {{v1::STEPPING_BACKWARD_EULER, Stepping::kBackwardEuler},
                                                      {v1::STEPPING_NEWMARK, Stepping::kNewmark},
                                                      {v1::STEPPING_BDF2, Stepping::kBdf2},
                                                      {v1::STEPPING_QUASI_STATIC, Stepping::kQuasiStatic}};
  for (const auto& [said, meant] : solved) {
    wire.mutable_tet()->set_stepping(said);
    EXPECT_EQ(method().stepping, meant);
    EXPECT_EQ(method().element, ElementOrder::kQuadratic);
  }
  wire.mutable_tet()->set_element(v1::ELEMENT_LINEAR);
  wire.mutable_tet()->set_volume(v1::VOLUME_FORM_ELEMENT);
  wire.mutable_tet()->set_newton_tolerance(1e-6);
  EXPECT_EQ(method().element, ElementOrder::kLinear);
  EXPECT_EQ(method().volume, VolumeForm::kElement);
  EXPECT_EQ(method().newton_tolerance, 1e-6);
  EXPECT_EQ(method().linear_solver, LinearSolver::kAutomatic);
  wire.mutable_tet()->set_linear_solver(v1::LINEAR_SOLVER_DIRECT);
  EXPECT_EQ(method().linear_solver, LinearSolver::kDirect);
  wire.mutable_tet()->set_linear_solver(v1::LINEAR_SOLVER_ITERATIVE);
  EXPECT_EQ(method().linear_solver, LinearSolver::kIterative);
  EXPECT_EQ(method().precision, Precision::kDouble);
  wire.mutable_tet()->set_stepping(v1::STEPPING_EXPLICIT);
  wire.mutable_tet()->set_precision(v1::PRECISION_SINGLE);
  EXPECT_EQ(method().precision, Precision::kSingle);
  wire.mutable_tet()->set_element(v1::ELEMENT_QUADRATIC);
  EXPECT_EQ(method().element, ElementOrder::kQuadratic);
}

// Two hexahedra on top of each other, the upper one with the tag 8.
const char kTwoHexahedra[] = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
12
1 0 0 0
2 10 0 0
3 10 10 0
4 0 10 0
5 0 0 10
6 10 0 10
7 10 10 10
8 0 10 10
9 0 0 20
10 10 0 20
11 10 10 20
12 0 10 20
$EndNodes
$Elements
3
1 3 2 1 1 1 4 3 2
2 5 2 7 7 1 2 3 4 5 6 7 8
3 5 2 8 8 5 6 7 8 9 10 11 12
$EndElements
)";

TEST(TranslateScene, HexahedralElementsKeepHexahedra) {
  v1::Scene wire = BoxScene();
  for (const double x : {0.0, 3.0, 4.0}) wire.mutable_bodies(0)->mutable_fibres()->mutable_constant()->add_direction(x);
  wire.mutable_tet()->set_element(v1::ELEMENT_HEXAHEDRAL);
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  EXPECT_EQ(scene->tet.element, ElementOrder::kHexahedral);
  const TetShape& shape = scene->bodies[0].tet();
  ASSERT_GT(shape.mesh.hexahedra.size(), 1u);
  EXPECT_EQ(shape.mesh.tetrahedra.size(), 6 * shape.mesh.hexahedra.size());
  EXPECT_EQ(shape.fibres.size(), shape.mesh.hexahedra.size());
  EXPECT_FALSE(scene->bodies[0].regions[1].sides.empty());
  EXPECT_EQ(scene->bodies[0].regions[1].triangles.size(), 2 * scene->bodies[0].regions[1].sides.size());
}

TEST(TranslateScene, HexahedraOfAFileAreKeptOrSplit) {
  Files files;
  v1::Scene wire = BoxScene();
  v1::Body& body = *wire.mutable_bodies(0);
  body.set_unit(v1::LENGTH_UNIT_MM);
  body.mutable_mesh()->mutable_file()->set_path("two.msh");
  body.mutable_mesh()->mutable_file()->set_asset(files.Add(kTwoHexahedra));
  body.clear_regions();
  body.clear_constraints();
  body.clear_loads();
  v1::Region& upper = *body.add_regions();
  upper.set_name("upper");
  upper.set_physical_tag(8);
  v1::Region& bottom = *body.add_regions();
  bottom.set_name("bottom");
  bottom.set_physical_tag(1);
  v1::RegionMaterial& stiff = *body.add_region_materials();
  stiff.set_region("upper");
  stiff.mutable_material()->mutable_neo_hookean()->set_young_modulus(1e5);
  for (const bool keep : {false, true}) {
    wire.mutable_tet()->set_element(keep ? v1::ELEMENT_HEXAHEDRAL : v1::ELEMENT_LINEAR);
    Problems problems;
    const auto scene = TranslateScene(wire, files.reader(), problems);
    ASSERT_NE(scene, nullptr) << problems.ToString();
    const Body& result = scene->bodies[0];
    EXPECT_EQ(result.tet().mesh.hexahedra.size(), keep ? 2u : 0u);
    EXPECT_EQ(result.tet().mesh.tetrahedra.size(), 12u);
    EXPECT_EQ(result.tet().materials.of, keep ? std::vector<std::int32_t>({0, 1})
                                              : std::vector<std::int32_t>({0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1}));
    EXPECT_EQ(result.regions[1].triangles.size(), 2u);
    EXPECT_EQ(result.regions[1].sides.size(), keep ? 1u : 0u);
    EXPECT_EQ(result.notes.size(), keep ? 0u : 1u);
    if (keep) continue;
    EXPECT_THAT(result.notes.at(0), HasSubstr("2 hexahedra were split into tetrahedra"));
  }
}

TEST(TranslateScene, MakesEveryLawWithItsParameters) {
  for (const LawInfo& law : Laws()) {
    v1::Scene wire = BoxScene();
    v1::Material& material = *wire.mutable_bodies(0)->mutable_material();
    material.Clear();
    const auto* field = material.GetDescriptor()->FindFieldByName(law.name);
    ASSERT_NE(field, nullptr) << law.name;
    auto* message = material.GetReflection()->MutableMessage(&material, field);
    std::vector<double> values;
    for (const ParameterInfo& parameter : law.parameters) {
      // Inside of every range, and a different value for each parameter.
      const double low = std::isfinite(parameter.min) ? parameter.min : -1;
      values.push_back(low + (std::min(parameter.max, low + 1) - low) * 0.1 * static_cast<double>(values.size() + 1));
      message->GetReflection()->SetDouble(message, message->GetDescriptor()->FindFieldByName(parameter.name),
                                          values.back());
    }
    for (const double x : {0.0, 0.0, 1.0})
      wire.mutable_bodies(0)->mutable_fibres()->mutable_constant()->add_direction(x);
    const auto scene = Translate(wire);
    ASSERT_NE(scene, nullptr) << law.name;
    // The same law with the same parameters gives the same stress.
    const Material expected = law.make(values);
    Mat3 F = Mat3::Identity();
    F(0, 1) = 0.3;
    F(2, 2) = 1.2;
    const FibreState fibre = {Vec3::UnitZ(), 0.5};
    const auto stress = [&](const Material& m) {
      return std::visit([&](const auto& l) { return l.Stress(F, fibre); }, m);
    };
    EXPECT_EQ(scene->bodies[0].material.index(), expected.index()) << law.name;
    EXPECT_EQ(stress(scene->bodies[0].material), stress(expected)) << law.name;
  }
}

TEST(TranslateScene, ReadsMeshFilesWithTags) {
  Files files;
  v1::Scene wire = BoxScene();
  v1::Body& body = *wire.mutable_bodies(0);
  body.set_unit(v1::LENGTH_UNIT_MM);
  body.mutable_mesh()->mutable_file()->set_path("two.msh");
  body.mutable_mesh()->mutable_file()->set_asset(files.Add(kTwoTets));
  body.mutable_regions(0)->set_physical_tag(1);
  body.mutable_regions(1)->set_physical_tag(7);
  const auto scene = Translate(wire, files);
  ASSERT_NE(scene, nullptr);
  EXPECT_NEAR(scene->bodies[0].tet().mesh.nodes[1].x(), 0.01, 1e-17);
  EXPECT_EQ(scene->bodies[0].tet().mesh.tetrahedra.size(), 2u);
  EXPECT_THAT(scene->bodies[0].regions[0].nodes, ElementsAre(0, 1, 2));
  EXPECT_EQ(scene->bodies[0].regions[1].nodes.size(), 5u);
}

TEST(TranslateScene, TurnsAMirroredMeshRound) {
  std::string mirrored = kTwoTets;
  mirrored.replace(mirrored.find("1 2 3 4\n3 4"), 7, "2 1 3 4");
  mirrored.replace(mirrored.find("2 3 4 5\n"), 7, "3 2 4 5");
  Files files;
  v1::Scene wire = BoxScene();
  v1::Body& body = *wire.mutable_bodies(0);
  body.set_unit(v1::LENGTH_UNIT_MM);
  body.mutable_mesh()->mutable_file()->set_path("two.msh");
  body.mutable_mesh()->mutable_file()->set_asset(files.Add(mirrored));
  body.mutable_regions(1)->set_physical_tag(1);
  const auto scene = Translate(wire, files);
  ASSERT_NE(scene, nullptr);
  EXPECT_GT(SignedVolume(scene->bodies[0].tet().mesh, 0), 0);
  EXPECT_GT(SignedVolume(scene->bodies[0].tet().mesh, 1), 0);
}

TEST(TranslateScene, ReadsFibresOfEverySource) {
  Files files;
  v1::Scene wire = BoxScene();
  v1::Body& body = *wire.mutable_bodies(0);
  v1::HarmonicFibres& harmonic = *body.mutable_fibres()->mutable_harmonic();
  harmonic.set_origin("bottom");
  harmonic.set_insertion("top");
  const auto along = Translate(wire);
  ASSERT_NE(along, nullptr);
  ASSERT_EQ(along->bodies[0].tet().fibres.size(), along->bodies[0].tet().mesh.tetrahedra.size());
  for (const Vec3& direction : along->bodies[0].tet().fibres) EXPECT_LT((direction - Vec3::UnitZ()).norm(), 1e-7);

  std::string text = "# one for each tetrahedron\n";
  for (std::size_t i = 0; i < along->bodies[0].tet().mesh.tetrahedra.size(); ++i) text += "0 3 4\n";
  body.mutable_fibres()->mutable_file()->set_path("fibres.txt");
  body.mutable_fibres()->mutable_file()->set_asset(files.Add(text));
  const auto read = Translate(wire, files);
  ASSERT_NE(read, nullptr);
  EXPECT_LT((read->bodies[0].tet().fibres.back() - Vec3(0, 0.6, 0.8)).norm(), 1e-15);
}

TEST(TranslateScene, ReadsBsplineFibres) {
  Files files;
  v1::Scene wire = BoxScene();
  v1::Body& body = *wire.mutable_bodies(0);
  v1::BsplineFibres& bspline = *body.mutable_fibres()->mutable_bspline();
  bspline.mutable_fitted()->set_origin("bottom");
  bspline.mutable_fitted()->set_insertion("top");
  const auto fitted = Translate(wire);
  ASSERT_NE(fitted, nullptr);
  ASSERT_EQ(fitted->bodies[0].tet().fibres.size(), fitted->bodies[0].tet().mesh.tetrahedra.size());
  for (const Vec3& direction : fitted->bodies[0].tet().fibres) EXPECT_GT(direction.z(), 0.9);

  // A block around the body in its unit, cm, whose fibres lean along y by 3 in 4.
  bspline.mutable_file()->set_path("solid.txt");
  bspline.mutable_file()->set_asset(files.Add(R"(bspline_solid degrees 1 1 1 controls 2 2 2 points
    -1 -9 -1   3 -9 -1   -1 9 -1   3 9 -1
    -1 -3  7   3 -3  7   -1 15 7   3 15 7)"));
  ASSERT_EQ(AssetsOf(wire).size(), 1u);
  const auto read = Translate(wire, files);
  ASSERT_NE(read, nullptr);
  for (const Vec3& direction : read->bodies[0].tet().fibres) EXPECT_LT((direction - Vec3(0, 0.6, 0.8)).norm(), 1e-12);
}

TEST(TranslateScene, TurnsFibresByTheirPennation) {
  v1::Scene wire = BoxScene();
  v1::Body& body = *wire.mutable_bodies(0);
  for (const double value : {0, 0, 2}) body.mutable_fibres()->mutable_constant()->add_direction(value);
  v1::Pennation& pennation = *body.mutable_fibres()->mutable_pennation();
  pennation.set_angle(0.4);
  for (const double value : {0, 3, 0}) pennation.add_normal(value);
  const auto all = Translate(wire);
  ASSERT_NE(all, nullptr);
  for (const Vec3& direction : all->bodies[0].tet().fibres) {
    EXPECT_LT((direction - Vec3(0, std::sin(0.4), std::cos(0.4))).norm(), 1e-15);
  }

  // About the middle of the body, which has 3 cm along y.
  for (const double value : {0.0, 1.5, 0.0}) pennation.add_mirror_point(value);
  const auto mirrored = Translate(wire);
  ASSERT_NE(mirrored, nullptr);
  const Body& half = mirrored->bodies[0];
  for (std::size_t e = 0; e < half.tet().fibres.size(); ++e) {
    const double distance = Centroid(half.tet().mesh, e).y() - 0.015;
    // The middle layer of tetrahedra has some with the centroid in the plane, up to round-off.
    if (std::abs(distance) < 1e-9) continue;
    EXPECT_LT((half.tet().fibres[e] - Vec3(0, std::copysign(std::sin(0.4), distance), std::cos(0.4))).norm(), 1e-12);
  }
}

// The estimate that guards memory before a shape is built must equal the size of the built shape.
TEST(TranslateScene, EstimatesShapesExactly) {
  for (const char* mesh :
       {"box { size: [0.1, 0.1, 0.1] divisions: [2, 3, 5] }",
        "fusiform { length: 0.2 belly_radius: 0.02 end_radius: 0.01 divisions_across: 4 divisions_along: 9 }",
        "torus { major_radius: 0.1 minor_radius: 0.02 divisions_around: 12 divisions_across: 4 }",
        "sphere { radius: 0.1 divisions: 6 }"}) {
    v1::Scene wire = ParseText(std::string(R"(duration: 1 tet {} output { frame_interval: 0.1 }
      bodies { name: "b" material { neo_hookean { young_modulus: 1e4 } } mesh { )") +
                               mesh + " } }");
    const auto scene = Translate(wire);
    ASSERT_NE(scene, nullptr);
    TranslateLimits limits;
    limits.max_elements = static_cast<std::int64_t>(scene->bodies[0].tet().mesh.tetrahedra.size());
    EXPECT_TRUE(ProblemsOf(wire, {}, limits).empty()) << mesh;
    limits.max_elements -= 1;
    EXPECT_FALSE(ProblemsOf(wire, {}, limits).empty()) << mesh;
  }
}

double ShearModulus(const Material& material) {
  return std::visit([](const auto& law) { return law.ShearModulus(); }, material);
}

TEST(TranslateScene, PartsOfABodyTakeTheirMaterials) {
  v1::Scene wire = BoxScene();
  Files files;
  v1::Body& body = *wire.mutable_bodies(0);
  google::protobuf::TextFormat::MergeFromString(R"(
    regions { name: "upper" plane { point: [0, 0, 2] normal: [0, 0, 1] } }
    regions { name: "uppermost" plane { point: [0, 0, 3] normal: [0, 0, 1] } }
    region_materials { region: "upper" material { neo_hookean { young_modulus: 2e4 poisson_ratio: 0 } } }
    region_materials { region: "uppermost" material { mooney_rivlin { c1: 3e4 bulk_modulus: 1e6 } } }
    element_parameters { path: "p.txt" })",
                                                &body);
  std::string text = "poisson_ratio young_modulus # columns\n";
  for (int t = 0; t < 144; ++t) text += "0 " + std::to_string(1000 + t) + "\n";
  body.mutable_element_parameters()->set_asset(files.Add(text));
  const auto scene = Translate(wire, files);
  ASSERT_NE(scene, nullptr);
  const Body& box = scene->bodies[0];
  ASSERT_EQ(box.tet().materials.of.size(), 144u);
  EXPECT_EQ(box.tet().materials.more.size(), 2u + 72u);
  EXPECT_NEAR(ShearModulus(box.material), 1e4 / 2.6, 1e-9);
  for (std::size_t t = 0; t < 72; ++t) EXPECT_NEAR(ShearModulus(MaterialOf(box, t)), (1000.0 + t) / 2, 1e-9);
  for (std::size_t t = 72; t < 108; ++t) EXPECT_NEAR(ShearModulus(MaterialOf(box, t)), 1e4, 1e-9);
  for (std::size_t t = 108; t < 144; ++t) EXPECT_TRUE(std::holds_alternative<MooneyRivlin>(MaterialOf(box, t)));
}

// Curves of a muscle: a published set, and a user's own ones in place of some of its; elements with their own
// parameters keep them.
TEST(TranslateScene, MusclesTakeTheirCurves) {
  v1::Scene wire = BoxScene();
  Files files;
  v1::Body& body = *wire.mutable_bodies(0);
  google::protobuf::TextFormat::ParseFromString(R"(
    tabulated_muscle {
      curves: PUBLISHED_CURVES_ALMONACID_2024
      active_length { lengths: [0.5, 1, 1.5] values: [0, 1, 0.25] }
      force_velocity { velocities: [-1, 0, 1] values: [0, 1, 1.5] } })",
                                                body.mutable_material());
  google::protobuf::TextFormat::MergeFromString(R"(
    fibres { constant { direction: [0, 0, 1] } prestretch: 1.25 } element_parameters { path: "p.txt" })",
                                                &body);
  std::string text = "peak_stress\n";
  for (int t = 0; t < 144; ++t) text += std::to_string(1000 + t) + "\n";
  body.mutable_element_parameters()->set_asset(files.Add(text));
  const auto scene = Translate(wire, files);
  ASSERT_NE(scene, nullptr);
  const Body& box = scene->bodies[0];
  const MuscleCurves published = CurvesOf(PublishedCurves::kAlmonacid2024);
  for (const std::size_t t : {0u, 143u}) {
    const auto& law = std::get<TabulatedMuscle>(MaterialOf(box, t));
    EXPECT_EQ(law.numbers().peak_stress, 1000.0 + t);
    EXPECT_EQ(law.curves().stress, CurveStress::kCauchy);
    EXPECT_EQ(
        law.curves().active_length.At(0.9).value,
        PointCurve(std::array{0.5, 1.0, 1.5}, std::array{0.0, 1.0, 0.25}, PointCurve::Beyond::kConstant).At(0.9).value);
    EXPECT_EQ(law.curves().passive_length.At(1.4).value, published.passive_length.At(1.4).value);
    EXPECT_EQ(law.curves().force_velocity.At(2.0).value, 1.5);
  }
  EXPECT_EQ(box.tet().prestretch, std::vector<double>(144, 1.25));
  // Without max_velocity the last curve has no effect.
  EXPECT_THAT(box.notes, ElementsAre(testing::HasSubstr("force_velocity: has no effect without max_velocity")));
}

// A Prony series for a body, which its elements with their own parameters share, and another one for a part of it.
TEST(TranslateScene, MaterialsTakeTheirViscoelasticity) {
  v1::Scene wire = BoxScene();
  Files files;
  v1::Body& body = *wire.mutable_bodies(0);
  google::protobuf::TextFormat::MergeFromString(R"(
    material { viscoelasticity { strengths: [0.5, 0.25] times: [0.1, 2] } }
    regions { name: "upper" plane { point: [0, 0, 2] normal: [0, 0, 1] } }
    region_materials { region: "upper" material { neo_hookean { young_modulus: 2e4 } } }
    element_parameters { path: "p.txt" })",
                                                &body);
  std::string text = "young_modulus\n";
  for (int t = 0; t < 144; ++t) text += std::to_string(1000 + t) + "\n";
  body.mutable_element_parameters()->set_asset(files.Add(text));
  const auto scene = Translate(wire, files);
  ASSERT_NE(scene, nullptr);
  const Body& box = scene->bodies[0];
  ASSERT_EQ(box.viscoelasticity.terms.size(), 2u);
  EXPECT_EQ(box.viscoelasticity.terms[1].strength, 0.25);
  EXPECT_EQ(box.viscoelasticity.terms[1].time, 2);
  const auto& parts = box.tet().viscoelasticity;
  ASSERT_EQ(parts.size(), box.tet().materials.more.size());
  EXPECT_TRUE(parts[0].terms.empty());
  for (std::size_t k = 1; k < parts.size(); ++k) EXPECT_EQ(parts[k].terms.size(), 2u);
}

TEST(TranslateScene, PartsOfABodyTakeTheirActivations) {
  v1::Scene wire = BoxScene();
  Files files;
  v1::Body& body = *wire.mutable_bodies(0);
  google::protobuf::TextFormat::MergeFromString(R"(
    regions { name: "upper" plane { point: [0, 0, 2] normal: [0, 0, 1] } }
    activation { times: 0 values: 0.25 }
    region_activations { region: "upper" curve { times: [0, 1] values: [0, 0.75] } }
    activation_scale { path: "s.txt" } initial_displacement { path: "u.txt" })",
                                                &body);
  std::string scale, displacement;
  for (int t = 0; t < 144; ++t) scale += std::to_string(t / 200.0) + "\n";
  for (int n = 0; n < 60; ++n) displacement += std::to_string(n) + " 0 -0.5\n";
  body.mutable_activation_scale()->set_asset(files.Add(scale));
  body.mutable_initial_displacement()->set_asset(files.Add(displacement));
  const auto scene = Translate(wire, files);
  ASSERT_NE(scene, nullptr);
  const Body& box = scene->bodies[0];
  EXPECT_EQ(box.activation.values, std::vector<double>({0.25}));
  ASSERT_EQ(box.tet().activations.more.size(), 1u);
  EXPECT_EQ(box.tet().activations.more[0].values, std::vector<double>({0, 0.75}));
  ASSERT_EQ(box.tet().activations.of.size(), 144u);
  for (std::size_t t = 0; t < 144; ++t) EXPECT_EQ(box.tet().activations.of[t], t < 72 ? 0 : 1);
  ASSERT_EQ(box.tet().activation_scale.size(), 144u);
  EXPECT_EQ(box.tet().activation_scale[100], 0.5);
  ASSERT_EQ(box.tet().initial_displacement.size(), 60u);
  EXPECT_LT((box.tet().initial_displacement[7] - Vec3(0.07, 0, -0.005)).norm(), 1e-17);
}

// An aponeurosis: the layer under one side of the upper part.
TEST(TranslateScene, RegionsWithinOthers) {
  v1::Scene wire = BoxScene();
  google::protobuf::TextFormat::MergeFromString(
      R"(regions { name: "upper" plane { point: [0, 0, 2] normal: [0, 0, 1] } }
         regions { name: "layer" side { direction: [1, 0, 0] depth: 0.5 } within: "upper" })",
      wire.mutable_bodies(0));
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  const std::vector<Region>& regions = scene->bodies[0].regions;
  const Region& upper = regions[regions.size() - 2];
  const Region& layer = regions.back();
  EXPECT_FALSE(layer.elements.empty());
  EXPECT_LT(layer.elements.size(), upper.elements.size());
  EXPECT_TRUE(
      std::includes(upper.elements.begin(), upper.elements.end(), layer.elements.begin(), layer.elements.end()));

  wire.mutable_bodies(0)->mutable_regions(wire.bodies(0).regions_size() - 1)->set_within(0, "layer");
  Problems problems;
  EXPECT_EQ(TranslateScene(wire, {}, problems), nullptr);
  EXPECT_THAT(problems.ToString(), ::testing::HasSubstr("within[0]"));
}

TEST(TranslateScene, FloorsHoldBodiesThatNothingElseHolds) {
  v1::Scene wire = BoxScene();
  wire.mutable_bodies(0)->clear_constraints();
  google::protobuf::TextFormat::MergeFromString(
      R"(gravity { acceleration: [0, 0, -9.81] } floors { name: "ground" point: [0, 0, -1] normal: [0, 0, 2] })",
      &wire);
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  ASSERT_EQ(scene->floors.size(), 1u);
  EXPECT_EQ(scene->floors[0].name, "ground");
  EXPECT_EQ(scene->floors[0].point, Vec3(0, 0, -1));
  EXPECT_EQ(scene->floors[0].normal, Vec3(0, 0, 1));

  Problems problems;
  wire.mutable_floors(0)->mutable_normal()->Set(2, -1);
  *wire.add_floors() = wire.floors(0);
  EXPECT_EQ(TranslateScene(wire, {}, problems), nullptr);
  EXPECT_THAT(problems.ToString(), ::testing::HasSubstr("floors[1].name"));
  EXPECT_THAT(problems.ToString(), ::testing::HasSubstr("inside of the floor"));
}

// Lengths are in the body's own unit; a plane's normal and a cylinder's axis turn its frame.
TEST(TranslateScene, RigidBodies) {
  v1::Scene wire = BoxScene();
  google::protobuf::TextFormat::MergeFromString(
      R"(rigid_bodies { name: "wall" plane { normal: [2, 0, 0] } position: [-1, 0, 0] }
         rigid_bodies { name: "rod" unit: LENGTH_UNIT_MM cylinder { radius: 5 length: 80 axis: [1, 0, 0] }
           position: [0, 0, -200] rotation: [0, 0, 1.5707963267948966] bodies: "box"
           motion { rotation { point: [0, 10, 0] axis: [0, 0, 3] angle { times: [0, 1] values: [0, 1] } } } }
         rigid_bodies { name: "block" unit: LENGTH_UNIT_CM box { size: [1, 2, 3] } position: [0, 0, 20] })",
      &wire);
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  const std::vector<RigidBody>& rigid = scene->rigid_bodies;
  ASSERT_EQ(rigid.size(), 3u);
  EXPECT_TRUE(std::holds_alternative<HalfSpace>(rigid[0].shape));
  EXPECT_EQ(rigid[0].pose.position, Vec3(-1, 0, 0)) << "in m";
  EXPECT_LT((RotationOf(rigid[0].pose) * Vec3::UnitZ() - Vec3::UnitX()).norm(), 1e-15);
  EXPECT_TRUE(rigid[0].bodies.empty());
  EXPECT_EQ(std::get<Cylinder>(rigid[1].shape).radius, 0.005);
  EXPECT_EQ(std::get<Cylinder>(rigid[1].shape).length, 0.08);
  EXPECT_EQ(rigid[1].pose.position, Vec3(0, 0, -0.2));
  EXPECT_LT((RotationOf(rigid[1].pose) * Vec3::UnitZ() - Vec3::UnitY()).norm(), 1e-15) << "its axis is turned, too";
  EXPECT_EQ(rigid[1].motion->rotation->point, Vec3(0, 0.01, 0));
  EXPECT_EQ(rigid[1].motion->rotation->axis, Vec3::UnitZ());
  EXPECT_EQ(rigid[1].bodies, std::vector<std::int32_t>{0});
  EXPECT_LT((std::get<Cuboid>(rigid[2].shape).size - Vec3(0.01, 0.02, 0.03)).norm(), 1e-17);
}

TEST(TranslateScene, RigidBodiesWithMistakes) {
  v1::Scene wire = BoxScene();
  google::protobuf::TextFormat::MergeFromString(
      R"(rigid_bodies { name: "wall" plane { normal: [2, 0, 0] } position: [-1, 0, 0] }
         rigid_bodies { name: "bone" unit: LENGTH_UNIT_MM cylinder { radius: 5 length: 80 axis: [1, 0, 0] }
           position: [0, 0, -200] rotation: [0, 0, 1.5707963267948966] bodies: "box"
           motion { rotation { point: [0, 10, 0] axis: [0, 0, 3] angle { times: [0, 1] values: [0, 1] } } } }
         rigid_bodies { name: "file" unit: LENGTH_UNIT_CM surface { path: "t.stl" asset: "assets/x" } friction: 0.5 }
         rigid_bodies { name: "wall" box { size: [1, 1, -1] } bodies: "bx" }
         contacts { bodies: ["box", "bax"] })",
      &wire);
  Problems problems;
  EXPECT_EQ(TranslateScene(wire, {}, problems), nullptr);
  for (const char* path : {"rigid_bodies[2].surface", "rigid_bodies[3].name", "rigid_bodies[3].box.size[2]",
                           "rigid_bodies[3].bodies[0]", "contacts[0].bodies[1]"}) {
    EXPECT_THAT(problems.ToString(), ::testing::HasSubstr(path));
  }
}

TEST(TranslateScene, ExcitationsKeepTheirDynamics) {
  v1::Scene wire = BoxScene();
  google::protobuf::TextFormat::MergeFromString(
      R"(excitation { curve { times: 0 values: 1 } activation_time: 0.02 initial_activation: 0.5 })",
      wire.mutable_bodies(0));
  const auto scene = Translate(wire);
  ASSERT_NE(scene, nullptr);
  const std::optional<Excitation>& excitation = scene->bodies[0].excitation;
  ASSERT_TRUE(excitation);
  EXPECT_EQ(excitation->curve.values, std::vector<double>({1}));
  EXPECT_EQ(excitation->dynamics.activation_time, 0.02);
  EXPECT_EQ(excitation->dynamics.deactivation_time, 0.04);
  EXPECT_EQ(excitation->dynamics.initial_activation, 0.5);
}

TEST(TranslateScene, RefusesRunsThatNeedTooMuch) {
  const v1::Scene wire = BoxScene();
  TranslateLimits limits;
  limits.max_memory = 1000;
  limits.max_stored_bytes = 100;
  Problems problems;
  const auto no_asset = [](const std::string&) { return std::optional<std::string>(); };
  EXPECT_EQ(TranslateScene(wire, no_asset, problems, limits), nullptr);
  EXPECT_THAT(problems.ToString(), HasSubstr("of memory"));
  EXPECT_THAT(problems.ToString(), HasSubstr("of the server's disk"));
}

TEST(TranslateScene, RegionsMayNotTakeManyTimesTheMemoryOfTheMesh) {
  v1::Scene wire = BoxScene();
  v1::Body& body = *wire.mutable_bodies(0);
  for (int axis = 0; axis < 3; ++axis) body.mutable_mesh()->mutable_box()->set_divisions(axis, 20);
  for (int i = 0; i < 1000; ++i) {
    v1::Region& region = *body.add_regions();
    region.set_name("all" + std::to_string(i));
    for (int axis = 0; axis < 3; ++axis) {
      region.mutable_box()->add_min(-1e3);
      region.mutable_box()->add_max(1e3);
    }
  }
  EXPECT_THAT(ProblemsOf(wire).ToString(), HasSubstr("several times as much memory as the mesh"));
  for (int i = 0; i < 2000; ++i) *body.add_regions() = body.regions(5);
  EXPECT_THAT(ProblemsOf(wire).ToString(), HasSubstr("at most 2000 are allowed"));
}

TEST(AssetsOf, NamesEachAssetOnce) {
  Files files;
  const std::string mesh = files.Add("a"), elements = files.Add("b"), fibres = files.Add("c");
  const std::string parameters = files.Add("d"), scale = files.Add("e"), displacement = files.Add("f");
  v1::Scene scene;
  for (int i = 0; i < 2; ++i) {
    v1::Body& body = *scene.add_bodies();
    body.mutable_mesh()->mutable_file()->set_asset(mesh);
    body.mutable_mesh()->mutable_elements()->set_asset(elements);
    body.mutable_fibres()->mutable_file()->set_asset(fibres);
    body.mutable_element_parameters()->set_asset(parameters);
    body.mutable_activation_scale()->set_asset(scale);
    body.mutable_initial_displacement()->set_asset(displacement);
  }
  scene.add_bodies()->mutable_mesh()->mutable_file()->set_asset("assets/XYZ");
  scene.add_bodies()->mutable_mesh()->mutable_box();
  EXPECT_THAT(AssetsOf(scene), ElementsAre(mesh.substr(7), elements.substr(7), fibres.substr(7), parameters.substr(7),
                                           scale.substr(7), displacement.substr(7)));
}

}  // namespace
}  // namespace fascicle::server
