// The FEBio reference problems, written as .feb in all versions, are imported as the original scenes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "client/import/febio_import.h"
#include "client/lib/scene_file.h"
#include "client/lib/scene_json.h"
#include "core/geometry/mesh_io.h"
#include "tests/support/feb_writer.h"
#include "tests/support/reference_file.h"

namespace fascicle::testing {
namespace {

using client::FebioOptions;
using client::ImportedScene;
using client::Notice;
using nlohmann::json;

constexpr double kNear = 1e-9;

ImportedScene Import(const std::string& model, const FebioOptions& options = {}) {
  Problems problems;
  auto imported = client::ImportFebio(model, options, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  return imported ? *imported : ImportedScene();
}

const std::string& FileOf(const ImportedScene& imported, const std::string& name) {
  static const std::string none;
  for (const client::ImportedFile& file : imported.files) {
    if (file.name == name) return file.bytes;
  }
  ADD_FAILURE() << "no file " << name;
  return none;
}

TetMesh MeshFileOf(const ImportedScene& imported) {
  const std::string& name = imported.scene.bodies(0).mesh().file().path();
  Problems problems;
  auto mesh = ReadMesh({name, FileOf(imported, name), {}}, problems);
  EXPECT_TRUE(problems.empty()) << problems.ToString();
  return mesh ? *mesh : TetMesh();
}

// The mesh has the model's corners and tetrahedra in the same order with the same bits, and the same mid-edge nodes.
void ExpectSameMesh(const FebMesh& model, const TetMesh& mesh) {
  std::vector<int> number(model.nodes.size(), -1);
  std::vector<int> corners;
  for (const std::vector<int>& element : model.elements)
    corners.insert(corners.end(), element.begin(), element.begin() + 4);
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  ASSERT_EQ(mesh.nodes.size(), corners.size());
  for (std::size_t c = 0; c < corners.size(); ++c) {
    number[static_cast<std::size_t>(corners[c])] = static_cast<int>(c);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(mesh.nodes[c][axis], model.nodes[static_cast<std::size_t>(corners[c])][axis]);
  }
  ASSERT_EQ(mesh.tetrahedra.size(), model.elements.size());
  std::map<std::array<std::int32_t, 2>, Vec3> curved;
  for (const CurvedEdge& edge : mesh.curved_edges) curved[edge.ends] = edge.middle;
  for (std::size_t t = 0; t < model.elements.size(); ++t) {
    const std::vector<int>& element = model.elements[t];
    for (int c = 0; c < 4; ++c) EXPECT_EQ(mesh.tetrahedra[t][c], number[static_cast<std::size_t>(element[c])]);
    for (std::size_t k = 0; element.size() == 10 && k < 6; ++k) {
      const auto [i, j] = std::minmax(mesh.tetrahedra[t][kTetEdges[k][0]], mesh.tetrahedra[t][kTetEdges[k][1]]);
      const auto found = curved.find({i, j});
      const Vec3 middle = found != curved.end() ? found->second : Vec3(0.5 * (mesh.nodes[i] + mesh.nodes[j]));
      const Point& own = model.nodes[static_cast<std::size_t>(element[4 + k])];
      EXPECT_LT((middle - Vec3(own[0], own[1], own[2])).norm(), 1e-7) << "element " << t << ", edge " << k;
    }
  }
}

// The nodes of a region by its tag, in the model's unit, are exactly those for which `inside` holds.
void ExpectRegion(const v1::Body& body, const TetMesh& mesh, const std::string& name,
                  const std::function<bool(const Point&)>& inside) {
  const auto region =
      std::find_if(body.regions().begin(), body.regions().end(), [&](const v1::Region& r) { return r.name() == name; });
  ASSERT_NE(region, body.regions().end()) << name;
  std::vector<char> chosen(mesh.nodes.size(), 0);
  for (std::size_t p = 0; p < mesh.node_tags.size(); ++p) {
    if (mesh.node_tags[p] == region->physical_tag()) chosen[static_cast<std::size_t>(mesh.tagged_nodes[p])] = 1;
  }
  for (std::size_t t = 0; t < mesh.triangle_tags.size(); ++t) {
    if (mesh.triangle_tags[t] != region->physical_tag()) continue;
    for (const std::int32_t n : mesh.tagged_triangles[t]) chosen[static_cast<std::size_t>(n)] = 1;
  }
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Vec3& x = mesh.nodes[n];
    EXPECT_EQ(bool(chosen[n]), inside({x[0], x[1], x[2]})) << name << ", node " << n;
  }
}

void ExpectRamp(const v1::Curve& curve, double value) {
  ASSERT_EQ(curve.times_size(), 2);
  EXPECT_EQ(curve.times(0), 0);
  EXPECT_EQ(curve.times(1), 1);
  ASSERT_EQ(curve.values_size(), 2);
  EXPECT_EQ(curve.values(0), 0);
  EXPECT_NEAR(curve.values(1), value, kNear * std::abs(value));
  EXPECT_TRUE(curve.interpolation() == v1::INTERPOLATION_UNSPECIFIED ||
              curve.interpolation() == v1::INTERPOLATION_LINEAR);
}

// One static step of ten increments; nothing of the model is missing or changed, also after writing the scene file.
void ExpectRest(const ImportedScene& imported, const std::string& element) {
  const v1::Scene& scene = imported.scene;
  ASSERT_EQ(scene.bodies_size(), 1);
  EXPECT_EQ(scene.bodies(0).unit(), v1::LENGTH_UNIT_MM);
  EXPECT_NEAR(scene.duration(), 1, kNear);
  EXPECT_NEAR(scene.output().frame_interval(), 0.1, kNear);
  EXPECT_EQ(scene.tet().stepping(), v1::STEPPING_QUASI_STATIC);
  EXPECT_EQ(scene.tet().element(), element == "tet4"    ? v1::ELEMENT_LINEAR
                                   : element == "tet10" ? v1::ELEMENT_QUADRATIC
                                                        : v1::ELEMENT_UNSPECIFIED);
  EXPECT_FALSE(scene.has_gravity());
  for (const Notice& notice : imported.notices) {
    EXPECT_EQ(notice.kind, Notice::Kind::kNote) << notice.where << ": " << notice.message;
  }
  Problems problems;
  const auto again = client::ParseScene(client::JsonText(scene), problems);
  ASSERT_TRUE(again) << problems.ToString();
  EXPECT_EQ(again->SerializeAsString(), scene.SerializeAsString());
}

struct Case {
  std::string version, element;
};

class ReferenceProblemTest : public ::testing::TestWithParam<Case> {
 protected:
  // The mesh of the problem's coarsest result with this element; skips the test if there is none.
  std::optional<FebMesh> MeshIn(const std::string& file, const std::string& key) {
    problem_ = ReadReference(file);
    if (!problem_) return std::nullopt;
    const json& fields = problem_->at(key);
    if (!fields.contains(GetParam().element)) return std::nullopt;
    return MeshOf(fields.at(GetParam().element));
  }
  std::string Skipped() const { return problem_ ? "the problem has no field of " + GetParam().element : NoReference(); }

  // A cantilever along x: its end pulled down by `force` [N] over an area of 1 mm^2.
  FebWriter Cantilever(FebMesh mesh, double force) {
    FebWriter feb(GetParam().version, std::move(mesh));
    feb.AddNodeSet("root", feb.Nodes(kRoot));
    feb.Fix("root", "xyz");
    feb.AddSurface("tip", feb.mesh().type == "tet10" ? "tri6" : "tri3", Facets(feb.mesh(), kTip));
    feb.AddLoad("<surface_load type=\"traction\" surface=\"tip\"><scale lc=\"1\">1</scale><traction>0,0," +
                Text(-force) + "</traction><linear>1</linear></surface_load>");
    return feb;
  }

  void ExpectCantilever(const ImportedScene& imported, const FebMesh& model, double force) {
    const v1::Body& body = imported.scene.bodies(0);
    const TetMesh mesh = MeshFileOf(imported);
    ExpectSameMesh(model, mesh);
    ExpectRegion(body, mesh, "root", kRoot);
    ExpectRegion(body, mesh, "tip", kTip);
    ASSERT_EQ(body.constraints_size(), 1);
    EXPECT_EQ(body.constraints(0).region(), "root");
    EXPECT_EQ(body.constraints(0).axes_size(), 0);
    EXPECT_FALSE(body.constraints(0).has_motion());
    ASSERT_EQ(body.loads_size(), 1);
    EXPECT_EQ(body.loads(0).region(), "tip");
    ExpectRamp(body.loads(0).scale(), 1);
    ASSERT_EQ(body.loads(0).traction().vector_size(), 3);
    EXPECT_EQ(body.loads(0).traction().vector(0), 0);
    EXPECT_EQ(body.loads(0).traction().vector(1), 0);
    EXPECT_NEAR(body.loads(0).traction().vector(2), -force * 1e6, kNear * force * 1e6);
  }

  static bool kRoot(const Point& x) { return x[0] == 0; }
  static bool kTip(const Point& x) { return x[0] == 10; }
  static bool kBottom(const Point& x) { return x[2] == 0; }

  std::optional<json> problem_;
};

class ReferenceTetrahedraTest : public ReferenceProblemTest {};

TEST_P(ReferenceProblemTest, NeoHookeanCantilever) {
  const auto mesh = MeshIn("a_cantilever_neohookean", "full_fields_coarsest_mesh");
  if (!mesh) GTEST_SKIP() << Skipped();
  FebWriter feb = Cantilever(*mesh, 1);
  feb.SetMaterial("neo-Hookean", "      <density>1</density><E>1000</E><v>0.3</v>\n");
  const ImportedScene imported = Import(feb.Model());
  ExpectRest(imported, mesh->type);
  ExpectCantilever(imported, *mesh, 1);
  const v1::NeoHookean& law = imported.scene.bodies(0).material().neo_hookean();
  EXPECT_NEAR(law.young_modulus(), 1e9, 1e9 * kNear);
  EXPECT_EQ(law.poisson_ratio(), 0.3);
}

// The same in the form used with FEBio: consistent nodal forces, one node set for each value.
TEST_P(ReferenceTetrahedraTest, NeoHookeanCantileverByNodalForces) {
  const auto mesh = MeshIn("a_cantilever_neohookean", "full_fields_coarsest_mesh");
  if (!mesh) GTEST_SKIP() << Skipped();
  FebWriter feb(GetParam().version, *mesh);
  feb.AddNodeSet("root", feb.Nodes(kRoot));
  feb.Fix("root", "xyz");
  feb.SetMaterial("neo-Hookean", "      <E>1000</E><v>0.3</v>\n");
  std::map<double, std::vector<int>> groups;
  for (const json& row : problem_->at("full_fields_coarsest_mesh").at("tet4").at("nodal_forces_final")) {
    groups[1e-9 * std::round(1e9 * row[3].get<double>())].push_back(row[0].get<int>());
  }
  ASSERT_EQ(groups.size(), 4u);  // one, two, three and six triangles at a node
  for (const auto& [force, nodes] : groups) {
    const std::string name = "tip" + std::to_string(nodes.size()) + "x" + std::to_string(std::lround(-1e4 * force));
    feb.AddNodeSet(name, nodes);
    const std::string place = "node_set=\"" + name + "\">";
    feb.AddLoad((feb.is_version_2() ? "<nodal_load bc=\"z\" " + place
                                    : "<nodal_load type=\"nodal_load\" " + place + "<dof>z</dof>") +
                "<scale lc=\"1\">" + Text(force) + "</scale></nodal_load>");
  }
  const ImportedScene imported = Import(feb.Model());
  ExpectRest(imported, mesh->type);
  const v1::Body& body = imported.scene.bodies(0);
  ASSERT_EQ(body.loads_size(), 4);
  double total = 0;
  auto group = groups.begin();
  for (const v1::Load& load : body.loads()) {
    EXPECT_NEAR(load.nodal_force().total(2), group->first * static_cast<double>(group->second.size()), 1e-12);
    ++group;
    total += load.nodal_force().total(2);
    ExpectRamp(load.scale(), 1);
  }
  EXPECT_NEAR(total, -1, 1e-7);
}

TEST_P(ReferenceProblemTest, BendingOfANearlyIncompressibleBeam) {
  const auto mesh = MeshIn("f_bending_locking", "full_fields_coarse");
  if (!mesh) GTEST_SKIP() << Skipped();
  FebWriter feb = Cantilever(*mesh, 5e-4);
  feb.SetMaterial("Mooney-Rivlin", "      <c1>0.03</c1><c2>0.01</c2><k>80</k>\n");
  const ImportedScene imported = Import(feb.Model());
  ExpectRest(imported, mesh->type);
  ExpectCantilever(imported, *mesh, 5e-4);
  const v1::MooneyRivlin& law = imported.scene.bodies(0).material().mooney_rivlin();
  EXPECT_NEAR(law.c1(), 0.03e6, 0.03e6 * kNear);
  EXPECT_NEAR(law.c2(), 0.01e6, 0.01e6 * kNear);
  EXPECT_NEAR(law.bulk_modulus(), 80e6, 80e6 * kNear);
}

TEST_P(ReferenceProblemTest, StretchedCube) {
  auto mesh = MeshIn("b_uniaxial_mooney_rivlin", "full_fields_clamped_coarse");
  if (GetParam().element == "tet4") mesh = Box(Vec3(10, 10, 10), {4, 4, 4});  // its field is not in the file
  if (!mesh) GTEST_SKIP() << Skipped();
  const auto top = [](const Point& x) { return x[2] == 10; };
  FebWriter feb(GetParam().version, *mesh);
  feb.AddNodeSet("bottom", feb.Nodes(kBottom));
  feb.AddNodeSet("top", feb.Nodes(top));
  feb.Fix("bottom", "xyz");
  feb.Fix("top", "xy");
  feb.Move("top", 'z', 5);
  feb.SetMaterial("Mooney-Rivlin", "      <c1>0.03</c1><c2>0.01</c2><k>80</k>\n");
  const ImportedScene imported = Import(feb.Model());
  ExpectRest(imported, mesh->type);
  const v1::Body& body = imported.scene.bodies(0);
  const TetMesh file = MeshFileOf(imported);
  ExpectSameMesh(*mesh, file);
  ExpectRegion(body, file, "bottom", kBottom);
  ExpectRegion(body, file, "top", top);
  ASSERT_EQ(body.constraints_size(), 2);
  EXPECT_EQ(body.constraints(1).region(), "top");
  EXPECT_EQ(body.constraints(1).axes_size(), 0);  // all three
  ASSERT_EQ(body.constraints(1).motion().translation_size(), 1);
  EXPECT_EQ(body.constraints(1).motion().translation(0).axis(), v1::AXIS_Z);
  ExpectRamp(body.constraints(1).motion().translation(0).curve(), 0.005);
}

TEST_P(ReferenceProblemTest, IsometricMuscle) {
  const auto mesh = MeshIn("d_fusiform_isometric", "full_fields_coarse");
  if (!mesh) GTEST_SKIP() << Skipped();
  const auto top = [](const Point& x) { return x[2] == 100; };
  FebWriter feb(GetParam().version, *mesh);
  feb.AddNodeSet("origin", feb.Nodes(kBottom));
  feb.AddNodeSet("insertion", feb.Nodes(top));
  feb.Fix("origin", "xyz");
  feb.Fix("insertion", "xyz");
  feb.SetMaterial("uncoupled solid mixture", MuscleOf(problem_->at("material")));
  const ImportedScene imported = Import(feb.Model());
  ExpectRest(imported, mesh->type);
  const v1::Body& body = imported.scene.bodies(0);
  const TetMesh file = MeshFileOf(imported);
  ExpectSameMesh(*mesh, file);
  ExpectRegion(body, file, "origin", kBottom);
  ExpectRegion(body, file, "insertion", top);
  ExpectRamp(body.activation(), 1);
  const v1::Muscle& law = body.material().muscle();
  EXPECT_NEAR(law.c1(), 0.03e6, 0.03e6 * kNear);
  EXPECT_NEAR(law.c2(), 0.01e6, 0.01e6 * kNear);
  EXPECT_NEAR(law.bulk_modulus(), 8e6, 8e6 * kNear);
  EXPECT_NEAR(law.peak_stress(), 0.3e6, 0.3e6 * kNear);
  EXPECT_EQ(law.optimal_stretch(), 1);
  EXPECT_EQ(law.passive_scale(), 0.05);
  EXPECT_EQ(law.passive_exponent(), 6.6);
  EXPECT_EQ(law.passive_transition(), 1.4);
  EXPECT_FALSE(law.has_max_velocity());
  // One fibre a tetrahedron, in the order of the mesh.
  std::istringstream fibres(FileOf(imported, body.fibres().file().path()));
  std::string comment;
  std::getline(fibres, comment);
  for (std::size_t t = 0; t < mesh->fibres.size(); ++t) {
    Vec3 own;
    fibres >> own[0] >> own[1] >> own[2];
    const Point& a = mesh->fibres[t];
    EXPECT_LT((own - Vec3(a[0], a[1], a[2])).norm(), 1e-7) << "tetrahedron " << t;
  }
  EXPECT_TRUE(fibres.good());
}

// Hexahedra are split as in the reference's meshes of tetrahedra, node by node.
TEST_P(ReferenceTetrahedraTest, HexahedraBecomeTheTetrahedraOfTheReference) {
  problem_ = ReadReference("d_fusiform_isometric");
  if (!problem_) GTEST_SKIP() << Skipped();
  const json& fields = problem_->at("full_fields_coarse");
  const FebMesh tetrahedra = MeshOf(fields.at("tet4"));
  FebWriter feb(GetParam().version, MeshOf(fields.at("hex8")));
  feb.AddNodeSet("origin", feb.Nodes(kBottom));
  feb.Fix("origin", "xyz");
  feb.SetMaterial("uncoupled solid mixture", MuscleOf(problem_->at("material")));
  FebioOptions options;
  options.split_hexahedra = true;
  const ImportedScene imported = Import(feb.Model(), options);
  ExpectRest(imported, "hex8");
  const TetMesh file = MeshFileOf(imported);
  ASSERT_EQ(file.tetrahedra.size(), tetrahedra.elements.size());
  std::set<std::array<int, 4>> expected, found;
  for (const std::vector<int>& element : tetrahedra.elements) {
    std::array<int, 4> nodes = {element[0], element[1], element[2], element[3]};
    std::sort(nodes.begin(), nodes.end());
    expected.insert(nodes);
  }
  for (std::array<std::int32_t, 4> nodes : file.tetrahedra) {
    std::sort(nodes.begin(), nodes.end());
    found.insert({nodes[0], nodes[1], nodes[2], nodes[3]});
  }
  EXPECT_EQ(found, expected);
}

// Without being split, they are kept: the same elements in the same order.
TEST_P(ReferenceTetrahedraTest, HexahedraAreKept) {
  problem_ = ReadReference("d_fusiform_isometric");
  if (!problem_) GTEST_SKIP() << Skipped();
  const FebMesh model = MeshOf(problem_->at("full_fields_coarse").at("hex8"));
  FebWriter feb(GetParam().version, model);
  feb.AddNodeSet("origin", feb.Nodes(kBottom));
  feb.Fix("origin", "xyz");
  feb.SetMaterial("uncoupled solid mixture", MuscleOf(problem_->at("material")));
  const ImportedScene imported = Import(feb.Model());
  EXPECT_EQ(imported.scene.tet().element(), v1::ELEMENT_HEXAHEDRAL);
  const TetMesh file = MeshFileOf(imported);
  ASSERT_EQ(file.hexahedra.size(), model.elements.size());
  for (std::size_t h = 0; h < file.hexahedra.size(); ++h) {
    for (std::size_t a = 0; a < 8; ++a) EXPECT_EQ(file.hexahedra[h][a], model.elements[h][a]);
  }
  ExpectRegion(imported.scene.bodies(0), file, "origin", kBottom);
}

std::string NameOf(const ::testing::TestParamInfo<Case>& instance) {
  return instance.param.element + "_" + instance.param.version.substr(0, 1);
}

INSTANTIATE_TEST_SUITE_P(Versions, ReferenceProblemTest,
                         ::testing::Values(Case{"4.0", "tet4"}, Case{"4.0", "tet10"}, Case{"3.0", "tet4"},
                                           Case{"3.0", "tet10"}, Case{"2.5", "tet4"}, Case{"2.5", "tet10"}),
                         NameOf);
INSTANTIATE_TEST_SUITE_P(Versions, ReferenceTetrahedraTest,
                         ::testing::Values(Case{"4.0", "tet4"}, Case{"3.0", "tet4"}, Case{"2.5", "tet4"}), NameOf);

}  // namespace
}  // namespace fascicle::testing
