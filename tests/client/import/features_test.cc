// The features of FEBio models, one by one: small models as text, and the resulting scenes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "client/import/febio_import.h"
#include "client/import/febio_mesh.h"
#include "core/geometry/mesh_io.h"
#include "tests/support/sample_models.h"

namespace fascicle::testing {
namespace {

using client::FebioOptions;
using client::ImportedScene;
using client::Notice;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A model made of pieces; each piece has a working default.
struct Pieces {
  std::string version = "4.0";
  std::string module = "<Module type=\"solid\"/>";
  std::string control = "<Control><time_steps>4</time_steps><step_size>0.25</step_size></Control>";
  std::string material = "<material id=\"1\" name=\"m\" type=\"neo-Hookean\"><E>1</E><v>0.3</v></material>";
  std::string nodes =
      "<node id=\"1\">0,0,0</node><node id=\"2\">10,0,0</node><node id=\"3\">0,10,0</node>"
      "<node id=\"4\">0,0,10</node><node id=\"5\">10,10,10</node>";
  std::string elements =
      "<Elements type=\"tet4\" name=\"p\"><elem id=\"1\">1,2,3,4</elem><elem id=\"2\">2,3,4,5</elem></Elements>";
  std::string sets = "<NodeSet name=\"s\">1,2,3</NodeSet><NodeSet name=\"t\">5</NodeSet>";
  std::string domains = "<SolidDomain name=\"p\" mat=\"m\"/>";
  std::string data;
  std::string boundary = "<bc type=\"zero displacement\" node_set=\"s\"><x_dof>1</x_dof></bc>";
  std::string loads;
  std::string curves =
      "<load_controller id=\"1\" type=\"loadcurve\"><points><pt>0,0</pt><pt>1,2</pt></points></load_controller>";
  std::string rest;

  std::string Model() const {
    return "<febio_spec version=\"" + version + "\">" + module + control + "<Material>" + material +
           "</Material><Mesh><Nodes>" + nodes + "</Nodes>" + elements + sets + "</Mesh><MeshDomains>" + domains +
           "</MeshDomains><MeshData>" + data + "</MeshData><Boundary>" + boundary + "</Boundary><Loads>" + loads +
           "</Loads><LoadData>" + curves + "</LoadData>" + rest + "</febio_spec>";
  }
};

ImportedScene Import(const Pieces& pieces, const FebioOptions& options = {}) {
  Problems problems;
  auto imported = client::ImportFebio(pieces.Model(), options, problems);
  EXPECT_TRUE(imported.has_value()) << problems.ToString();
  return imported ? *imported : ImportedScene();
}

std::string Refusal(const Pieces& pieces, const FebioOptions& options = {}) {
  Problems problems;
  EXPECT_FALSE(client::ImportFebio(pieces.Model(), options, problems).has_value());
  return problems.ToString();
}

// "KIND where: message" of each notice.
std::string NoticesOf(const ImportedScene& imported) {
  std::string text;
  for (const Notice& notice : imported.notices) {
    const char* kind = notice.kind == Notice::Kind::kNotTaken  ? "unsupported "
                       : notice.kind == Notice::Kind::kChanged ? "changed "
                                                               : "setting ";
    text += kind + notice.where + ": " + notice.message + "\n";
  }
  return text;
}

TetMesh ImportedMeshOf(const ImportedScene& imported, int body = 0) {
  Problems problems;
  const std::string& name = imported.scene.bodies(body).mesh().file().path();
  for (const client::ImportedFile& file : imported.files) {
    if (file.name == name) return ReadMesh({name, file.bytes, {}}, problems).value_or(TetMesh());
  }
  return {};
}

// c1, c2 and k of a trans iso Mooney-Rivlin solid with its fibres.
const char* kFibres = "<c3>0.2</c3><c4>30</c4><c5>5</c5><lam_max>1.05</lam_max>";

TEST(FebioUnitsTest, ScaleStressesLengthsAndForces) {
  Pieces pieces;
  pieces.boundary += "<bc type=\"prescribed displacement\" node_set=\"t\"><dof>z</dof><value lc=\"1\">1</value></bc>";
  pieces.loads = "<nodal_load type=\"nodal_force\" node_set=\"t\"><value lc=\"1\">0,3,0</value></nodal_load>";
  struct Expected {
    const char* units;
    double modulus, displacement, force, coordinate;
    v1::LengthUnit unit;
  };
  for (const Expected& e :
       {Expected{"mm-N-MPa", 1e6, 2e-3, 3, 10, v1::LENGTH_UNIT_MM}, Expected{"SI", 1, 2, 3, 10, v1::LENGTH_UNIT_M},
        Expected{"mm-kg-s", 1e3, 2e-3, 3e-3, 10, v1::LENGTH_UNIT_MM},
        Expected{"CGS", 0.1, 2e-2, 3e-5, 10, v1::LENGTH_UNIT_CM}}) {
    FebioOptions options;
    options.units = e.units;
    const ImportedScene imported = Import(pieces, options);
    const v1::Body& body = imported.scene.bodies(0);
    EXPECT_EQ(body.unit(), e.unit);
    EXPECT_NEAR(body.material().neo_hookean().young_modulus(), e.modulus, 1e-12 * e.modulus);
    EXPECT_NEAR(body.constraints(1).motion().translation(0).curve().values(1), e.displacement, 1e-12 * e.displacement);
    EXPECT_NEAR(body.loads(0).nodal_force().total(1), e.force, 1e-12 * e.force);
    EXPECT_EQ(ImportedMeshOf(imported).nodes[1][0], e.coordinate);
  }
}

TEST(FebioUnitsTest, ComeFromTheFileUnlessTheyAreGiven) {
  Pieces pieces;
  pieces.module = "<Module type=\"solid\"><units>CGS</units></Module>";
  EXPECT_EQ(Import(pieces).units, "CGS");
  FebioOptions options;
  options.units = "mm-N-MPa";
  EXPECT_EQ(Import(pieces, options).units, "mm-N-s");
  EXPECT_EQ(Import(Pieces()).units, "mm-N-s");
  options.units = "inch";
  EXPECT_THAT(Refusal(Pieces(), options), HasSubstr("`inch`"));
}

TEST(FebioUnitsTest, WrongOnesAreSuspectedByTheSizeOfTheBody) {
  Pieces pieces;
  pieces.nodes.replace(pieces.nodes.find("10,0,0"), 6, "30,0,0");
  FebioOptions options;
  options.units = "SI";
  EXPECT_THAT(Refusal(pieces, options),
              HasSubstr("30 m long; no muscle is longer than 10 m (the units are taken as SI"));
}

TEST(FebioUnitsTest, MicronsBecomeMillimetres) {
  Pieces pieces;
  FebioOptions options;
  options.units = "um-nN-s";
  pieces.nodes =
      "<node id=\"1\">0,0,0</node><node id=\"2\">500,0,0</node><node id=\"3\">0,500,0</node>"
      "<node id=\"4\">0,0,500</node><node id=\"5\">500,500,500</node>";
  const ImportedScene imported = Import(pieces, options);
  EXPECT_EQ(imported.scene.bodies(0).unit(), v1::LENGTH_UNIT_MM);
  EXPECT_NEAR(ImportedMeshOf(imported).nodes[1][0], 0.5, 1e-15);
  EXPECT_NEAR(imported.scene.bodies(0).material().neo_hookean().young_modulus(), 1e3, 1e-9);
}

TEST(FebioMaterialTest, IsotropicLaws) {
  Pieces pieces;
  for (const char* type : {"isotropic elastic", "St.Venant-Kirchhoff"}) {
    pieces.material = std::string("<material id=\"1\" name=\"m\" type=\"") + type + "\"><E>2</E><v>0.4</v></material>";
    const v1::StVenantKirchhoff law = Import(pieces).scene.bodies(0).material().st_venant_kirchhoff();
    EXPECT_DOUBLE_EQ(law.young_modulus(), 2e6);
    EXPECT_EQ(law.poisson_ratio(), 0.4);
  }
  pieces.material = "<material id=\"1\" name=\"m\" type=\"incomp neo-Hookean\"><G>0.5</G><k>100</k></material>";
  const v1::MooneyRivlin law = Import(pieces).scene.bodies(0).material().mooney_rivlin();
  EXPECT_DOUBLE_EQ(law.c1(), 0.25e6);
  EXPECT_EQ(law.c2(), 0);
  EXPECT_DOUBLE_EQ(law.bulk_modulus(), 100e6);
}

TEST(FebioMaterialTest, TransverselyIsotropicMooneyRivlin) {
  Pieces pieces;
  pieces.material = std::string("<material id=\"1\" name=\"m\" type=\"trans iso Mooney-Rivlin\"><c1>1</c1><k>100</k>") +
                    kFibres + "<fiber type=\"vector\">0,0,2</fiber></material>";
  const ImportedScene imported = Import(pieces);
  const v1::Body& body = imported.scene.bodies(0);
  const v1::TransIsoMooneyRivlin& law = body.material().trans_iso_mooney_rivlin();
  EXPECT_DOUBLE_EQ(law.c1(), 1e6);
  EXPECT_DOUBLE_EQ(law.c3(), 0.2e6);
  EXPECT_EQ(law.c4(), 30);
  EXPECT_DOUBLE_EQ(law.c5(), 5e6);
  EXPECT_EQ(law.lam_max(), 1.05);
  EXPECT_FALSE(law.has_active_stress());
  EXPECT_THAT(body.fibres().constant().direction(), ElementsAre(0, 0, 1));
  // FEBio's own active contraction is a different law, which is not supported.
  pieces.material.insert(pieces.material.find("<fiber"),
                         "<active_contraction lc=\"1\"><ascl>1</ascl></active_contraction>");
  EXPECT_THAT(NoticesOf(Import(pieces)),
              HasSubstr("unsupported model.feb:1: Material/material `m`/active_contraction"));
}

TEST(FebioMaterialTest, MixtureWithActiveContraction) {
  Pieces pieces;
  pieces.material =
      "<material id=\"1\" name=\"m\" type=\"uncoupled solid mixture\"><k>100</k>"
      "<mat_axis type=\"vector\"><a>0,1,0</a><d>1,0,0</d></mat_axis>"
      "<solid type=\"Mooney-Rivlin\"><c1>1</c1><c2>0</c2></solid>"
      "<solid type=\"uncoupled fiber-exp-linear\"><c3>0.2</c3><c4>30</c4><c5>5</c5><lambda>1.05</lambda></solid>"
      "<solid type=\"uncoupled prescribed uniaxial active contraction\"><T0 lc=\"2\">0.4</T0></solid></material>";
  pieces.curves +=
      "<load_controller id=\"2\" type=\"loadcurve\"><points><pt>0,0</pt><pt>1,0.5</pt></points></load_controller>";
  const ImportedScene imported = Import(pieces);
  const v1::Body& body = imported.scene.bodies(0);
  EXPECT_DOUBLE_EQ(body.material().trans_iso_mooney_rivlin().active_stress(), 0.4e6);
  EXPECT_EQ(body.material().trans_iso_mooney_rivlin().lam_max(), 1.05);
  EXPECT_THAT(body.activation().values(), ElementsAre(0, 0.5));
  EXPECT_THAT(body.fibres().constant().direction(), ElementsAre(0, 1, 0));
  // An activation beyond 1 is invalid.
  pieces.curves =
      "<load_controller id=\"2\" type=\"loadcurve\"><points><pt>0,0</pt><pt>1,3</pt></points></load_controller>";
  EXPECT_THAT(Refusal(pieces), HasSubstr("reaches 3; values may be in [0, 1]"));
}

TEST(FebioMaterialTest, TendonAndMuscleInOneBody) {
  Pieces pieces;
  const std::string matrix = "<solid type=\"Mooney-Rivlin\"><c1>0.03</c1><c2>0.01</c2><k>8</k></solid>";
  pieces.material =
      "<material id=\"1\" name=\"muscle\" type=\"uncoupled solid mixture\">" + matrix +
      "<solid type=\"muscle material\"><p1>0.05</p1><p2>6.6</p2><Lofl>1.2</Lofl><smax>0.3</smax>"
      "<lam_max>1.8</lam_max><activation>0.5</activation><fiber type=\"vector\">0,0,1</fiber></solid></material>"
      "<material id=\"2\" name=\"tendon\" type=\"uncoupled solid mixture\">" +
      matrix +
      "<solid type=\"tendon material\"><l1>2.7</l1><l2>46.4</l2><lam_max>1.03</lam_max>"
      "<fiber type=\"local\">1,2</fiber></solid></material>";
  pieces.elements =
      "<Elements type=\"tet4\" name=\"belly\"><elem id=\"1\">1,2,3,4</elem></Elements>"
      "<Elements type=\"tet4\" name=\"end\"><elem id=\"2\">2,3,4,5</elem></Elements>";
  pieces.domains = "<SolidDomain name=\"end\" mat=\"tendon\"/><SolidDomain name=\"belly\" mat=\"1\"/>";
  const ImportedScene imported = Import(pieces);
  ASSERT_EQ(imported.scene.bodies_size(), 1);
  const v1::Body& body = imported.scene.bodies(0);
  EXPECT_EQ(body.name(), "belly");
  EXPECT_NEAR(body.material().muscle().passive_transition(), 1.5, 1e-15);
  EXPECT_DOUBLE_EQ(body.material().muscle().bulk_modulus(), 8e6);
  ASSERT_EQ(body.region_materials_size(), 1);
  EXPECT_EQ(body.region_materials(0).region(), "end");
  EXPECT_DOUBLE_EQ(body.region_materials(0).material().tendon().fibre_scale(), 2.7e6);
  // The region's tag is that of the second tetrahedron.
  const auto& region = body.regions(0);
  EXPECT_EQ(region.name(), "end");
  EXPECT_THAT(ImportedMeshOf(imported).tetrahedron_tags, ElementsAre(1, region.physical_tag()));
  // Fixed from the end of the first step on.
  EXPECT_THAT(body.activation().times(), ElementsAre(0, 0.25));
  EXPECT_THAT(body.activation().values(), ElementsAre(0, 0.5));
  // Fibres along z in the muscle, along the edge from node 2 to node 3 in the tendon.
  const std::string& fibres = imported.files.back().bytes;
  double v[6];
  ASSERT_EQ(
      std::sscanf(fibres.c_str() + fibres.find('\n'), "%lf %lf %lf %lf %lf %lf", v, v + 1, v + 2, v + 3, v + 4, v + 5),
      6);
  EXPECT_THAT((std::vector<double>{v[0], v[1], v[2]}), ElementsAre(0, 0, 1));
  EXPECT_NEAR(v[3], -std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(v[4], std::sqrt(0.5), 1e-15);
}

TEST(FebioFibreTest, AxesAnglesMapsAndElementData) {
  Pieces pieces;
  const auto material = [](const std::string& inner) {
    return std::string("<material id=\"1\" name=\"m\" type=\"trans iso Mooney-Rivlin\"><c1>1</c1><k>100</k>") +
           kFibres + inner + "</material>";
  };
  const auto direction = [&] {
    const ImportedScene imported = Import(pieces);
    const auto& d = imported.scene.bodies(0).fibres().constant().direction();
    return d.size() == 3 ? Vec3(d[0], d[1], d[2]) : Vec3(Vec3::Zero());
  };
  pieces.material = material("<fiber type=\"angles\"><theta>90</theta><phi>45</phi></fiber>");
  EXPECT_LT((direction() - Vec3(0, std::sqrt(0.5), std::sqrt(0.5))).norm(), 1e-15);
  // A fibre along the second of some rotated axes.
  pieces.material =
      material("<mat_axis type=\"vector\"><a>0,0,1</a><d>1,0,0</d></mat_axis><fiber type=\"vector\">0,1,0</fiber>");
  EXPECT_LT((direction() - Vec3(1, 0, 0)).norm(), 1e-15);
  pieces.material = material("<fiber type=\"map\">f</fiber>");
  pieces.data =
      "<ElementData name=\"f\" data_type=\"vec3\" elem_set=\"p\"><elem lid=\"1\">0,3,0</elem><elem "
      "lid=\"2\">0,1,0</elem>"
      "</ElementData>";
  EXPECT_LT((direction() - Vec3(0, 1, 0)).norm(), 1e-15);
  pieces.material = material("");
  pieces.data =
      "<ElementData type=\"mat_axis\" elem_set=\"p\"><elem lid=\"1\"><a>0,0,1</a><d>1,0,0</d></elem>"
      "<elem lid=\"2\"><a>0,0,1</a><d>0,1,0</d></elem></ElementData>";
  EXPECT_LT((direction() - Vec3(0, 0, 1)).norm(), 1e-15);
  pieces.data = "<ElementData type=\"fiber\" elem_set=\"p\"><elem lid=\"3\">0,0,1</elem></ElementData>";
  EXPECT_THAT(Refusal(pieces), HasSubstr("lid 3 is not in the set"));
  pieces.data.clear();
  pieces.material = material("<fiber type=\"local\">1,7</fiber>");
  EXPECT_THAT(Refusal(pieces), HasSubstr("refers to more nodes than the elements"));
}

TEST(FebioLoadTest, PressureActsAgainstTheFacetsNormals) {
  Pieces pieces;
  pieces.sets += "<Surface name=\"f\"><tri3 id=\"1\">1,3,2</tri3><tri3 id=\"2\">1,4,3</tri3></Surface>";
  pieces.loads =
      "<surface_load type=\"pressure\" surface=\"f\"><pressure "
      "lc=\"1\">0.5</pressure><linear>1</linear></surface_load>";
  ImportedScene imported = Import(pieces);
  const v1::Body& body = imported.scene.bodies(0);
  ASSERT_EQ(body.loads_size(), 2);  // two directions
  // Node order 1,3,2 faces down; 1,4,3 faces -x.
  EXPECT_THAT(body.loads(0).traction().vector(), ElementsAre(0.5e6, 0, 0));
  EXPECT_THAT(body.loads(1).traction().vector(), ElementsAre(0, 0, 0.5e6));
  EXPECT_NE(body.loads(0).region(), body.loads(1).region());
  EXPECT_EQ(NoticesOf(imported), "");
  pieces.loads = "<surface_load type=\"pressure\" surface=\"f\"><pressure>0.5</pressure></surface_load>";
  EXPECT_THAT(NoticesOf(Import(pieces)),
              HasSubstr("changed model.feb:1: Loads/surface_load `pressure`/pressure: keeps"));
}

TEST(FebioLoadTest, BodyForcesActAgainstTheirVector) {
  Pieces pieces;
  pieces.material =
      "<material id=\"1\" name=\"m\" type=\"neo-Hookean\"><density>1e-9</density><E>1</E><v>0.3</v></material>";
  pieces.loads = "<body_load type=\"const\"><x>0</x><z lc=\"1\">9810</z></body_load>";
  const ImportedScene imported = Import(pieces);
  EXPECT_THAT(imported.scene.gravity().acceleration(), ElementsAre(0, 0, ::testing::DoubleEq(-9.81)));
  EXPECT_THAT(imported.scene.gravity().scale().values(), ElementsAre(0, 2));
  EXPECT_NEAR(imported.scene.bodies(0).density(), 1000, 1e-9);
  pieces.material = Pieces().material;
  EXPECT_THAT(Refusal(pieces), HasSubstr("has no density"));
}

TEST(FebioLoadTest, NodeSetsMayBeSurfacesAndParts) {
  Pieces pieces;
  pieces.sets += "<Surface name=\"f\"><tri3 id=\"1\">1,3,2</tri3></Surface>";
  pieces.boundary =
      "<bc type=\"zero displacement\" node_set=\"@surface:f\"><x_dof>1</x_dof></bc>"
      "<bc type=\"zero displacement\" node_set=\"@elem_set:p\"><y_dof>1</y_dof></bc>";
  const ImportedScene imported = Import(pieces);
  const TetMesh mesh = ImportedMeshOf(imported);
  const auto count = [&](int constraint) {
    const std::string& name = imported.scene.bodies(0).constraints(constraint).region();
    for (const v1::Region& region : imported.scene.bodies(0).regions()) {
      if (region.name() == name) return std::count(mesh.node_tags.begin(), mesh.node_tags.end(), region.physical_tag());
    }
    return std::ptrdiff_t{0};
  };
  EXPECT_EQ(count(0), 3);
  EXPECT_EQ(count(1), 5);
}

v1::Curve CurveOf(const std::string& controller) {
  Pieces pieces;
  pieces.curves = controller;
  pieces.boundary +=
      "<bc type=\"prescribed displacement\" node_set=\"t\"><dof>z</dof><value lc=\"1\">1000</value></bc>";
  const ImportedScene imported = Import(pieces);
  if (imported.scene.bodies_size() == 0) return {};
  return imported.scene.bodies(0).constraints(1).motion().translation(0).curve();
}

std::string Controller(const std::string& inner) {
  return "<load_controller id=\"1\" type=\"loadcurve\">" + inner + "</load_controller>";
}

TEST(FebioCurveTest, StepsTakeTheValueOfTheNextPoint) {
  const v1::Curve curve =
      CurveOf(Controller("<interpolate>STEP</interpolate><points><pt>0,0</pt><pt>0.5,1</pt><pt>1,1</pt></points>"));
  ASSERT_EQ(curve.times_size(), 4);
  EXPECT_THAT(curve.values(), ElementsAre(0, 1, 1, 1));
  EXPECT_NEAR(curve.times(1), 0.5e-6, 1e-12);
  EXPECT_EQ(curve.times(2), 0.5);
}

// FEBio's "smooth" curve through points of a parabola is that parabola.
TEST(FebioCurveTest, SmoothCurvesAreSampled) {
  const v1::Curve curve =
      CurveOf(Controller("<interpolate>SMOOTH</interpolate><points><pt>0,0</pt><pt>0.25,0.0625</pt><pt>0.5,0.25</pt>"
                         "<pt>0.75,0.5625</pt><pt>1,1</pt></points>"));
  ASSERT_EQ(curve.times_size(), 81);
  for (int i = 0; i < curve.times_size(); ++i) EXPECT_NEAR(curve.values(i), curve.times(i) * curve.times(i), 1e-12);
}

TEST(FebioCurveTest, SmoothStepsAreSampled) {
  const v1::Curve curve =
      CurveOf(Controller("<interpolate>SMOOTH STEP</interpolate><points><pt>0,0</pt><pt>1,1</pt></points>"));
  ASSERT_EQ(curve.times_size(), 21);
  EXPECT_NEAR(curve.values(10), 0.5, 1e-12);
  EXPECT_NEAR(curve.values(5), 0.103515625, 1e-12);  // w^3 (10 - 15 w + 6 w^2) at 1/4
}

TEST(FebioCurveTest, LinesAreExtrapolatedWhereTheySaySo) {
  const std::string points = "<points><pt>0,0</pt><pt>0.5,1</pt></points>";
  EXPECT_THAT(CurveOf(Controller(points)).times(), ElementsAre(0, 0.5));
  const v1::Curve curve = CurveOf(Controller("<extend>EXTRAPOLATE</extend>" + points));
  EXPECT_THAT(curve.times(), ElementsAre(0, 0.5, 1));
  EXPECT_THAT(curve.values(), ElementsAre(0, 1, 2));
  Pieces pieces;
  pieces.boundary += "<bc type=\"prescribed displacement\" node_set=\"t\"><dof>z</dof><value lc=\"1\">1</value></bc>";
  pieces.curves = Controller("<extend>REPEAT</extend>" + points);
  EXPECT_THAT(Refusal(pieces), HasSubstr("repeats itself"));
}

TEST(FebioCurveTest, MotionsStartAtRest) {
  const v1::Curve curve = CurveOf(Controller("<points><pt>0,1</pt><pt>1,3</pt></points>"));
  EXPECT_THAT(curve.times(), ElementsAre(0, 0.25, 1));
  EXPECT_THAT(curve.values(), ElementsAre(0, 1.5, 3));
}

TEST(FebioStepTest, DynamicAnalysisAndFrames) {
  Pieces pieces;
  pieces.material =
      "<material id=\"1\" name=\"m\" type=\"neo-Hookean\"><density>1.1e-9</density><E>1</E><v>0.3</v></material>";
  pieces.control =
      "<Control><analysis>DYNAMIC</analysis><time_steps>20</time_steps><step_size>0.05</step_size>"
      "<plot_stride>2</plot_stride><solver><rhoi>0</rhoi></solver></Control>";
  const ImportedScene imported = Import(pieces);
  EXPECT_EQ(imported.scene.tet().stepping(), v1::STEPPING_NEWMARK);
  EXPECT_NEAR(imported.scene.duration(), 1, 1e-12);
  EXPECT_NEAR(imported.scene.output().frame_interval(), 0.1, 1e-12);
  EXPECT_THAT(NoticesOf(imported), HasSubstr("setting model.feb:1: Control: solver"));
}

TEST(FebioStepTest, OneStepIsTaken) {
  Pieces pieces;
  pieces.rest = "<Step><step id=\"1\">" + pieces.control +
                "<Boundary><bc type=\"zero displacement\" node_set=\"t\"><z_dof>1</z_dof></bc></Boundary></step>"
                "<step id=\"2\"><Control/></step></Step>";
  pieces.control.clear();
  const ImportedScene imported = Import(pieces);
  EXPECT_EQ(imported.scene.bodies(0).constraints_size(), 2);
  EXPECT_THAT(NoticesOf(imported), HasSubstr("unsupported model.feb:1: Step/step `2`: a scene has one step"));
}

TEST(FebioNoticeTest, EverythingThatIsNotTakenIsTold) {
  Pieces pieces;
  pieces.rest =
      "\n<Contact>\n<contact name=\"c\" type=\"sliding-elastic\" surface_pair=\"p\"/></Contact>\n"
      "<Initial><ic type=\"velocity\" node_set=\"t\"><value>1,0,0</value></ic></Initial>\n<Constraints/>\n<Output/>";
  pieces.boundary += "<bc type=\"rigid\" node_set=\"t\"><rb>2</rb></bc>";
  pieces.loads = "<surface_load type=\"fluid traction\" surface=\"x\"/><edge_load type=\"force\"/>";
  pieces.material.insert(pieces.material.find("</material>"), "<youth>7</youth>");
  const std::string notices = NoticesOf(Import(pieces));
  for (const char* notice :
       {"unsupported model.feb:2: Contact", "unsupported model.feb:4: Initial", "unsupported model.feb:5: Constraints",
        "unsupported model.feb:1: Boundary/bc `rigid`", "unsupported model.feb:1: Loads/surface_load `fluid traction`",
        "unsupported model.feb:1: Loads/edge_load `force`", "unsupported model.feb:1: Material/material `m`/youth"}) {
    EXPECT_THAT(notices, HasSubstr(notice));
  }
  EXPECT_THAT(notices, ::testing::Not(HasSubstr("Output")));
}

TEST(FebioMeshTest, PartsThatShareNoFaceAreBodies) {
  Pieces pieces;
  pieces.nodes +=
      "<node id=\"11\">20,0,0</node><node id=\"12\">30,0,0</node><node id=\"13\">20,10,0</node><node "
      "id=\"14\">20,0,10</node>";
  pieces.elements += "<Elements type=\"tet4\" name=\"q 2\"><elem id=\"7\">11,12,13,14</elem></Elements>";
  pieces.domains += "<SolidDomain name=\"q 2\" mat=\"m\"/>";
  pieces.sets = "<NodeSet name=\"s\">1,2,11</NodeSet>";
  pieces.loads = "<nodal_load type=\"nodal_load\" node_set=\"s\"><dof>y</dof><scale>2</scale></nodal_load>";
  const ImportedScene imported = Import(pieces);
  ASSERT_EQ(imported.scene.bodies_size(), 2);
  EXPECT_EQ(imported.scene.bodies(1).name(), "q_2");
  EXPECT_EQ(ImportedMeshOf(imported, 1).nodes.size(), 4u);
  // Each body gets its fraction of the forces.
  EXPECT_THAT(imported.scene.bodies(0).loads(0).nodal_force().total(), ElementsAre(0, 4, 0));
  EXPECT_THAT(imported.scene.bodies(1).loads(0).nodal_force().total(), ElementsAre(0, 2, 0));
  EXPECT_FALSE(imported.scene.bodies(0).loads(0).has_scale());
  EXPECT_THAT(NoticesOf(imported), HasSubstr("2 bodies"));
}

TEST(FebioMeshTest, RigidPartsAndShellsAreLeftOut) {
  Pieces pieces;
  pieces.material += "<material id=\"2\" name=\"bone\" type=\"rigid body\"><density>1</density></material>";
  pieces.elements =
      "<Elements type=\"tet4\" name=\"p\"><elem id=\"1\">1,2,3,4</elem></Elements>"
      "<Elements type=\"tet4\" name=\"b\"><elem id=\"2\">2,3,4,5</elem></Elements>"
      "<Elements type=\"tri3\" name=\"skin\"><elem id=\"3\">1,2,3</elem></Elements>";
  pieces.domains += "<SolidDomain name=\"b\" mat=\"bone\"/><ShellDomain name=\"skin\" mat=\"m\"/>";
  pieces.boundary += "<bc type=\"zero displacement\" node_set=\"t\"><z_dof>1</z_dof></bc>";
  const ImportedScene imported = Import(pieces);
  EXPECT_EQ(ImportedMeshOf(imported).tetrahedra.size(), 1u);
  const std::string notices = NoticesOf(imported);
  EXPECT_THAT(notices, HasSubstr("MeshDomains/SolidDomain `b`: a rigid body"));
  EXPECT_THAT(notices, HasSubstr("Mesh/Elements `skin`: elements of type `tri3` have no volume"));
  EXPECT_THAT(notices, HasSubstr("MeshDomains/ShellDomain `skin`"));
  EXPECT_THAT(notices, HasSubstr("Boundary/bc `zero displacement`: none of its nodes"));
}

// A hexahedron, a wedge and a pyramid side by side: volumes add up, and the split faces match.
TEST(FebioMeshTest, HexahedraWedgesAndPyramidsAreSplit) {
  Pieces pieces;
  pieces.nodes =
      "<node id=\"8\">0,0,0</node><node id=\"2\">10,0,0</node><node id=\"5\">10,10,0</node><node id=\"1\">0,10,0</node>"
      "<node id=\"9\">0,0,10</node><node id=\"3\">10,0,10</node><node id=\"4\">10,10,10</node><node "
      "id=\"7\">0,10,10</node>"
      "<node id=\"20\">20,5,0</node><node id=\"21\">20,5,10</node><node id=\"30\">5,5,20</node>";
  pieces.elements =
      "<Elements type=\"hex8\" name=\"h\"><elem id=\"1\">8,2,5,1,9,3,4,7</elem></Elements>"
      "<Elements type=\"penta6\" name=\"w\"><elem id=\"2\">2,20,5,3,21,4</elem></Elements>"
      "<Elements type=\"pyra5\" name=\"y\"><elem id=\"3\">9,3,4,7,30</elem></Elements>";
  pieces.domains =
      "<SolidDomain name=\"h\" mat=\"m\"/><SolidDomain name=\"w\" mat=\"m\"/><SolidDomain name=\"y\" mat=\"m\"/>";
  pieces.sets = "<NodeSet name=\"s\">8,2,5,1</NodeSet><Surface name=\"f\"><quad4 id=\"1\">8,1,5,2</quad4></Surface>";
  pieces.loads =
      "<surface_load type=\"traction\" surface=\"f\"><traction>0,0,1</traction><linear>1</linear></surface_load>";
  EXPECT_THAT(Refusal(pieces), HasSubstr("--split-hexahedra"));
  FebioOptions options;
  options.split_hexahedra = true;
  const ImportedScene imported = Import(pieces, options);
  ASSERT_EQ(imported.scene.bodies_size(), 1);
  const TetMesh mesh = ImportedMeshOf(imported);
  EXPECT_EQ(mesh.tetrahedra.size(), 6u + 3u + 2u);
  EXPECT_NEAR(TotalVolume(mesh), 1000 + 500 + 1000.0 / 3, 1e-9);
  // Ten outer squares of two triangles each, and six triangles: no face inside is left unmatched.
  EXPECT_EQ(BoundaryTriangles(mesh).size(), 4u * 2 + (2 * 2 + 2) + 4u);
  EXPECT_EQ(mesh.tagged_triangles.size(), 2u);
  EXPECT_EQ(imported.scene.tet().element(), v1::ELEMENT_UNSPECIFIED);
}

TEST(FebioMeshTest, SetsAsElementsAndElementSets) {
  Pieces pieces;
  pieces.version = "3.0";
  pieces.sets = "<NodeSet name=\"s\"><n id=\"1\"/><n id=\"2\"/></NodeSet><ElementSet name=\"e\">2</ElementSet>";
  pieces.boundary = "<bc type=\"fix\" node_set=\"s\"><dofs>x, z</dofs></bc>";
  pieces.material = std::string("<material id=\"1\" name=\"m\" type=\"trans iso Mooney-Rivlin\"><c1>1</c1><k>100</k>") +
                    kFibres + "<fiber type=\"user\"/></material>";
  pieces.data = "<ElementData var=\"fiber\" elem_set=\"e\"><elem lid=\"1\">0,1,0</elem></ElementData>";
  const ImportedScene imported = Import(pieces);
  EXPECT_THAT(imported.scene.bodies(0).constraints(0).axes(), ElementsAre(v1::AXIS_X, v1::AXIS_Z));
  EXPECT_THAT(imported.files.back().bytes, HasSubstr("1 0 0\n0 1 0\n"));
}

TEST(FebioImportTest, AModelWithMostOfWhatThereIs) {
  FebioOptions options;
  options.split_hexahedra = true;
  Problems problems;
  const auto imported = client::ImportFebio(kRichModel, options, problems);
  ASSERT_TRUE(imported.has_value()) << problems.ToString();
  const v1::Body& body = imported->scene.bodies(0);
  EXPECT_EQ(body.loads_size(), 3);
  EXPECT_EQ(body.constraints_size(), 2);
  EXPECT_EQ(ImportedMeshOf(*imported).tetrahedra.size(), 6u + 3u + 1u);
  EXPECT_THAT(NoticesOf(*imported), HasSubstr(": Contact"));
}

// The mesh alone, with its parts and sets as tags.
TEST(FebioMeshTest, PartsAndSetsBecomeTags) {
  Pieces pieces;
  pieces.elements =
      "<Elements type=\"tet4\" name=\"p\"><elem id=\"1\">1,2,3,4</elem></Elements>"
      "<Elements type=\"penta6\" name=\"w\"><elem id=\"2\">1,3,2,6,8,7</elem></Elements>";
  pieces.nodes += "<node id=\"6\">0,0,-10</node><node id=\"7\">10,0,-10</node><node id=\"8\">0,10,-10</node>";
  pieces.sets +=
      "<ElementSet name=\"both\">1,2</ElementSet>"
      "<Surface name=\"side\"><quad4 id=\"1\">1,2,7,6</quad4><tri3 id=\"2\">1,2,4</tri3></Surface>";
  Problems problems;
  MeshRemarks remarks;
  EXPECT_FALSE(client::ReadFebioMesh("m.feb", pieces.Model(), false, problems, {}, remarks));
  EXPECT_THAT(problems.ToString(), HasSubstr("--split-hexahedra"));
  Problems none;
  const auto mesh = client::ReadFebioMesh("m.feb", pieces.Model(), true, none, {}, remarks);
  ASSERT_TRUE(mesh) << none.ToString();
  double volume = 0;
  for (std::size_t t = 0; t < mesh->tetrahedra.size(); ++t) volume += std::abs(SignedVolume(*mesh, t));
  EXPECT_DOUBLE_EQ(volume, 1000.0 / 6 + 500);
  EXPECT_THAT(mesh->tetrahedron_tags, ElementsAre(1, 2, 2, 2));
  EXPECT_EQ(mesh->further_tags.size(), 4u);
  EXPECT_THAT(mesh->triangle_tags, ElementsAre(4, 4, 4));
  EXPECT_EQ(mesh->nodes.size(), 7u) << "node 5 belongs to no element";
  std::vector<std::string> names;
  for (const TagName& name : remarks.names) names.push_back(name.name);
  EXPECT_THAT(names, ElementsAre("p", "w", "both", "side", "s", "t"));
  EXPECT_THAT(mesh->node_tags, ElementsAre(5, 5, 5));
}

}  // namespace
}  // namespace fascicle::testing
