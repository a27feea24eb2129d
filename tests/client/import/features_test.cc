// The features of FEBio models, one by one: small models as text, and the resulting scenes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "client/import/febio_import.h"
#include "client/import/febio_mesh.h"
#include "core/geometry/mesh_io.h"
#include "model_pieces.h"
#include "tests/support/sample_models.h"

namespace fascicle::testing {
namespace {

using client::FebioOptions;
using client::ImportedScene;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TetMesh ImportedMeshOf(const ImportedScene& imported, int body = 0) {
  Problems problems;
  const std::string& name = imported.scene.bodies(body).mesh().file().path();
  for (const client::ImportedFile& file : imported.files) {
    if (file.name == name) return ReadMesh({name, file.bytes, {}}, problems).value_or(TetMesh());
  }
  return {};
}

// The fibre of each tetrahedron.
std::vector<Vec3> FibresOf(const ImportedScene& imported, int body = 0) {
  std::vector<Vec3> fibres;
  for (const client::ImportedFile& file : imported.files) {
    if (file.name != imported.scene.bodies(body).fibres().file().path()) continue;
    std::istringstream text(file.bytes.substr(file.bytes.find('\n')));
    for (Vec3 fibre; text >> fibre[0] >> fibre[1] >> fibre[2];) fibres.push_back(fibre);
  }
  return fibres;
}

MATCHER_P3(ElementsAreNear, x, y, z, "") { return (arg - Vec3(x, y, z)).norm() < 1e-12; }

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
}

// FEBio's active contraction is another law; the nearest one has the same stress at rest length.
TEST(FebioMaterialTest, ActiveContractionBecomesTheNearestLaw) {
  Pieces pieces;
  pieces.material = std::string("<material id=\"1\" name=\"m\" type=\"trans iso Mooney-Rivlin\"><c1>1</c1><k>100</k>") +
                    kFibres +
                    "<active_contraction><ascl lc=\"1\">1</ascl><Tmax>0.5</Tmax><ca0>4.35</ca0><beta>4.75</beta>"
                    "<l0>1.58</l0><refl>2.04</refl></active_contraction></material>";
  EXPECT_THAT(Refusal(pieces), HasSubstr("model.feb:1: Material/material `m`/active_contraction: changed: its Cauchy "
                                         "stress grows with sarcomere length"));
  const v1::Body body = Import(pieces).scene.bodies(0);
  // T of [Guccione, McCulloch 1993] at stretch 1, with the largest value of the load curve, 2.
  const double growth = std::exp(4.75 * (2.04 - 1.58)) - 1;
  EXPECT_NEAR(body.material().trans_iso_mooney_rivlin().active_stress(), 2 * 0.5e6 / (1 + 1 / growth), 1e-3);
  EXPECT_THAT(body.activation().values(), ElementsAre(0, 1));
}

// Beyond lam_max FEBio's stress is constant with c5 = 0, and so is the law's to nine digits.
TEST(FebioMaterialTest, FibresWithoutASlopeBeyondTheirTransition) {
  Pieces pieces;
  pieces.material =
      "<material id=\"1\" name=\"m\" type=\"trans iso Mooney-Rivlin\"><c1>1</c1><k>100</k><c3>0.2</c3><c4>8</c4>"
      "<c5>0</c5><lam_max>20</lam_max></material>";
  const ImportedScene imported = Import(pieces);
  const v1::TransIsoMooneyRivlin law = imported.scene.bodies(0).material().trans_iso_mooney_rivlin();
  EXPECT_GT(law.c5(), 0);
  EXPECT_DOUBLE_EQ(law.c5(), 1e-9 * law.c3());
  EXPECT_EQ(law.lam_max(), 10);
  EXPECT_THAT(NoticesOf(imported), HasSubstr("note model.feb:1: Material/material `m`/lam_max: is taken as 10"));
}

TEST(FebioMaterialTest, MuscleAndTendonMaterialByThemselves) {
  Pieces pieces;
  pieces.material =
      "<material id=\"1\" name=\"m\" type=\"muscle material\"><g1>0.02</g1><g2>0.04</g2><p1>0.05</p1><p2>6.6</p2>"
      "<Lofl>1.1</Lofl><smax>0.3</smax><lam_max>1.54</lam_max><k>10</k><activation lc=\"1\">0.5</activation>"
      "<fiber type=\"vector\">0,0,1</fiber></material>";
  ImportedScene imported = Import(pieces);
  EXPECT_EQ(NoticesOf(imported), "");
  const v1::Body body = imported.scene.bodies(0);
  const v1::BlemkerMuscle& muscle = body.material().blemker_muscle();
  EXPECT_DOUBLE_EQ(muscle.along_modulus(), 0.02e6);
  EXPECT_DOUBLE_EQ(muscle.across_modulus(), 0.04e6);
  EXPECT_DOUBLE_EQ(muscle.bulk_modulus(), 10e6);
  EXPECT_DOUBLE_EQ(muscle.peak_stress(), 0.3e6);
  EXPECT_NEAR(muscle.passive_transition(), 1.4, 1e-15);
  EXPECT_THAT(body.activation().values(), ElementsAre(0, 1));
  pieces.material =
      "<material id=\"1\" name=\"m\" type=\"tendon material\"><g1>50</g1><g2>60</g2><l1>2.7</l1><l2>46.4</l2>"
      "<lam_max>1.03</lam_max><k>500</k><fiber type=\"vector\">0,0,1</fiber></material>";
  imported = Import(pieces);
  EXPECT_EQ(NoticesOf(imported), "");
  const v1::BlemkerTendon tendon = imported.scene.bodies(0).material().blemker_tendon();
  EXPECT_DOUBLE_EQ(tendon.along_modulus(), 50e6);
  EXPECT_DOUBLE_EQ(tendon.across_modulus(), 60e6);
  EXPECT_DOUBLE_EQ(tendon.fibre_scale(), 2.7e6);
  EXPECT_EQ(tendon.transition_stretch(), 1.03);
}

TEST(FebioMaterialTest, DensityWithoutUnitsTellsThem) {
  Pieces pieces;
  pieces.control =
      "<Control><analysis>DYNAMIC</analysis><time_steps>4</time_steps><step_size>0.25</step_size></Control>";
  struct Expected {
    const char *density, *units;
    double in_scene;
  };
  for (const Expected& e : {Expected{"1", "CGS", 1000}, Expected{"1060", "SI", 1060}, Expected{"1e-6", "mm-kg-s", 1000},
                            Expected{"1.06e-9", "mm-N-s", 1060}}) {
    pieces.material = "<material id=\"1\" name=\"m\" type=\"neo-Hookean\"><density>" + std::string(e.density) +
                      "</density><E>2</E><v>0.3</v></material>";
    if (e.density == std::string("1060")) pieces.nodes.replace(pieces.nodes.find("10,0,0"), 6, "9,00,0");
    const ImportedScene imported = Import(pieces);
    EXPECT_EQ(imported.units, e.units);
    EXPECT_NEAR(imported.scene.bodies(0).density(), e.in_scene, 1e-9 * e.in_scene);
    const bool told = NoticesOf(imported).find("no units are named") != std::string::npos;
    EXPECT_EQ(told, e.units != std::string("mm-N-s")) << NoticesOf(imported);
  }
  pieces.module = "<Module type=\"solid\"><units>mm-N-s</units></Module>";
  pieces.material =
      "<material id=\"1\" name=\"m\" type=\"neo-Hookean\"><density>1</density><E>2</E><v>0.3</v></material>";
  EXPECT_THAT(Refusal(pieces), HasSubstr("its density is 1e+12 kg/m^3 in the units mm-N-s"));
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
  // Where the load curve exceeds 1, its largest value goes to the stress.
  pieces.curves =
      "<load_controller id=\"2\" type=\"loadcurve\"><points><pt>0,0</pt><pt>1,3</pt></points></load_controller>";
  const v1::Body scaled = Import(pieces).scene.bodies(0);
  EXPECT_DOUBLE_EQ(scaled.material().trans_iso_mooney_rivlin().active_stress(), 1.2e6);
  EXPECT_THAT(scaled.activation().values(), ElementsAre(0, ::testing::DoubleEq(1)));
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
  // Local nodes, also as elements of their own.
  for (const char* form : {"<fiber type=\"local\">1,2</fiber>", "<fiber type=\"local\"><local>1,2</local></fiber>",
                           "<mat_axis type=\"local\"><local>1,2,4</local></mat_axis>"}) {
    pieces.material = material(form);
    EXPECT_THAT(FibresOf(Import(pieces)),
                ElementsAre(Vec3(1, 0, 0), ElementsAreNear(-std::sqrt(0.5), std::sqrt(0.5), 0)))
        << form;
  }
  pieces.material = material("<fiber type=\"local\">1,7</fiber>");
  EXPECT_THAT(Refusal(pieces), HasSubstr("refers to more nodes than the elements"));
}

// Around z the radial vector at a centroid, the circumferential one, and one of a sphere.
TEST(FebioFibreTest, RoundFibresAtTheCentroids) {
  Pieces pieces;
  const std::string before =
      std::string("<material id=\"1\" name=\"m\" type=\"trans iso Mooney-Rivlin\"><c1>1</c1><k>100</k>") + kFibres;
  const auto fibres = [&](const std::string& form) {
    pieces.material = before + form + "</material>";
    return FibresOf(Import(pieces));
  };
  const Vec3 first(2.5, 2.5, 2.5), second(5, 5, 5);
  const Vec3 centre(1, -2, 0);
  const auto radial = [&](const Vec3& x) {
    Vec3 r = x - centre;
    r[2] = 0;
    return Vec3(r.normalized());
  };
  const auto cylinder = [](const char* vector) {
    return std::string("<fiber type=\"cylindrical\"><center>1,-2,0</center><axis>0,0,2</axis><vector>") + vector +
           "</vector></fiber>";
  };
  std::vector<Vec3> got = fibres(cylinder("1,0,0"));
  ASSERT_EQ(got.size(), 2u);
  EXPECT_LT((got[0] - radial(first)).norm(), 1e-12);
  EXPECT_LT((got[1] - radial(second)).norm(), 1e-12);
  got = fibres(cylinder("0,3,0"));
  EXPECT_LT((got[0] - Vec3::UnitZ().cross(radial(first))).norm(), 1e-12);
  for (const char* form : {"<fiber type=\"spherical\">1,-2,0</fiber>",
                           "<fiber type=\"spherical\"><center>1,-2,0</center><vector>1,0,0</vector></fiber>",
                           "<mat_axis type=\"spherical\"><center>1,-2,0</center></mat_axis>"}) {
    got = fibres(form);
    EXPECT_LT((got[0] - (first - centre).normalized()).norm(), 1e-12) << form;
    EXPECT_LT((got[1] - (second - centre).normalized()).norm(), 1e-12) << form;
  }
  pieces.material = before + "<fiber type=\"cylindrical\"><axis>0,0,0</axis></fiber></material>";
  EXPECT_THAT(Refusal(pieces), HasSubstr("fiber `cylindrical`/axis: is zero"));
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
}

// Without <linear> it follows the surface, against the normals of the facets.
TEST(FebioLoadTest, PressureFollowsTheSurface) {
  Pieces pieces;
  pieces.loads = "<surface_load type=\"pressure\" surface=\"f\"><pressure>0.5</pressure></surface_load>";
  const std::string sets = pieces.sets;
  pieces.sets = sets + "<Surface name=\"f\"><tri3 id=\"1\">1,3,2</tri3><tri3 id=\"2\">1,4,3</tri3></Surface>";
  ImportedScene imported = Import(pieces);
  ASSERT_EQ(imported.scene.bodies(0).loads_size(), 1);
  EXPECT_EQ(imported.scene.bodies(0).loads(0).pressure().value(), 0.5e6);
  EXPECT_EQ(NoticesOf(imported), "");
  // The second facet faces inwards.
  pieces.sets = sets + "<Surface name=\"f\"><tri3 id=\"1\">1,3,2</tri3><tri3 id=\"2\">1,3,4</tri3></Surface>";
  imported = Import(pieces);
  const v1::Body& body = imported.scene.bodies(0);
  ASSERT_EQ(body.loads_size(), 2);
  EXPECT_EQ(body.loads(0).pressure().value() + body.loads(1).pressure().value(), 0);
  EXPECT_NE(body.loads(0).region(), body.loads(1).region());
}

// The coefficients are FEBio's own.
TEST(FebioMaterialTest, OgdenAndYeohOfUpToThreeTerms) {
  Pieces pieces;
  pieces.material =
      "<material id=\"1\" name=\"m\" type=\"Ogden\"><c1>0.02</c1><m1>2.5</m1><c2>0.01</c2><m2>-2</m2><k>80</k>"
      "</material>";
  const v1::Ogden ogden = Import(pieces).scene.bodies(0).material().ogden();
  EXPECT_NEAR(ogden.c1(), 2e4, 1e-9);
  EXPECT_EQ(ogden.m1(), 2.5);
  EXPECT_NEAR(ogden.c2(), 1e4, 1e-9);
  EXPECT_EQ(ogden.m2(), -2);
  EXPECT_EQ(ogden.c3(), 0);
  EXPECT_NEAR(ogden.bulk_modulus(), 8e7, 1e-6);
  pieces.material =
      "<material id=\"1\" name=\"m\" type=\"Yeoh\"><c1>0.02</c1><c2>-0.001</c2><c3>0.003</c3><k>80</k></material>";
  const v1::Yeoh yeoh = Import(pieces).scene.bodies(0).material().yeoh();
  EXPECT_NEAR(yeoh.c1(), 2e4, 1e-9);
  EXPECT_NEAR(yeoh.c2(), -1e3, 1e-9);
  EXPECT_NEAR(yeoh.c3(), 3e3, 1e-9);
  pieces.material = "<material id=\"1\" name=\"m\" type=\"Yeoh\"><c1>0.02</c1><c4>0.003</c4><k>80</k></material>";
  EXPECT_THAT(Refusal(pieces), HasSubstr("is a term beyond the third"));
}

// A pressure with a number for each facet, as a map or as a formula of one.
TEST(FebioLoadTest, PressuresByFacet) {
  Pieces pieces;
  pieces.sets += "<Surface name=\"f\"><tri3 id=\"1\">1,3,2</tri3><tri3 id=\"2\">1,4,3</tri3></Surface>";
  pieces.data =
      "<SurfaceData name=\"p_map\" surface=\"f\" data_type=\"scalar\"><face lid=\"1\">0.5</face><face "
      "lid=\"2\">0.2</face>"
      "</SurfaceData>";
  const auto load = [](const std::string& pressure) {
    return "<surface_load type=\"pressure\" surface=\"f\">" + pressure + "<linear>1</linear></surface_load>";
  };
  for (const char* pressure :
       {"<pressure lc=\"1\" type=\"map\">p_map</pressure>", "<pressure lc=\"1\" type=\"math\">1*p_map</pressure>"}) {
    pieces.loads = load(pressure);
    const ImportedScene imported = Import(pieces);
    EXPECT_EQ(NoticesOf(imported), "");
    const v1::Body& body = imported.scene.bodies(0);
    ASSERT_EQ(body.loads_size(), 2) << pressure;
    EXPECT_THAT(body.loads(0).traction().vector(), ElementsAre(0.2e6, 0, 0));
    EXPECT_THAT(body.loads(1).traction().vector(), ElementsAre(0, 0, 0.5e6));
    EXPECT_THAT(body.loads(0).scale().values(), ElementsAre(0, 2));
  }
  pieces.loads = load("<pressure type=\"math\">1*q</pressure>");
  EXPECT_THAT(Refusal(pieces), HasSubstr("surface_load `pressure`/pressure `math`: `1*q` depends on `q`"));
  pieces.data.replace(pieces.data.find("lid=\"2\""), 7, "lid=\"3\"");
  EXPECT_THAT(Refusal(pieces), HasSubstr("lid 3 is not a facet of the surface"));
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
  EXPECT_THAT(NoticesOf(imported), HasSubstr("note model.feb:1: Control: solver"));
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
  pieces.boundary += "<bc type=\"linear constraint\" node_set=\"t\"/>";
  pieces.loads = "<surface_load type=\"fluid traction\" surface=\"x\"/><edge_load type=\"force\"/>";
  pieces.material.insert(pieces.material.find("</material>"), "<youth>7</youth>");
  const std::string notices = NoticesOf(Import(pieces));
  for (const char* notice :
       {"unsupported model.feb:2: Contact", "unsupported model.feb:4: Initial",
        "unsupported model.feb:1: Boundary/bc `linear constraint`",
        "unsupported model.feb:1: Loads/surface_load `fluid traction`",
        "unsupported model.feb:1: Loads/edge_load `force`", "unsupported model.feb:1: Material/material `m`/youth"}) {
    EXPECT_THAT(notices, HasSubstr(notice));
  }
  EXPECT_THAT(notices, ::testing::Not(HasSubstr("Output")));
  EXPECT_THAT(notices, ::testing::Not(HasSubstr("Constraints"))) << "it is empty";
  // Without --accept-loss all of them are problems, with what to do.
  const std::string refusal = Refusal(pieces);
  EXPECT_THAT(refusal, HasSubstr("model.feb:2: Contact: not supported (remove it, or declare contact in the scene, or "
                                 "import without it by --accept-loss)"));
  EXPECT_THAT(refusal, HasSubstr("model.feb:1: Loads/edge_load `force`: not supported"));
  EXPECT_EQ(std::count(refusal.begin(), refusal.end(), '\n'), std::count(notices.begin(), notices.end(), '\n'));
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

// Two tetrahedra with a common side, the second of which is rigid, and a skin.
Pieces WithRigidPart() {
  Pieces pieces;
  pieces.material += "\n<material id=\"2\" name=\"bone\" type=\"rigid body\"><density>1</density></material>";
  pieces.elements =
      "<Elements type=\"tet4\" name=\"p\"><elem id=\"1\">1,2,3,4</elem></Elements>"
      "<Elements type=\"tet4\" name=\"b\"><elem id=\"2\">2,3,4,5</elem></Elements>";
  pieces.domains += "<SolidDomain name=\"b\" mat=\"bone\"/>";
  pieces.boundary.clear();
  return pieces;
}

// The numbers of the model's nodes of a constraint's region.
std::vector<double> HeightsOf(const ImportedScene& imported, int constraint) {
  const v1::Body& body = imported.scene.bodies(0);
  const TetMesh mesh = ImportedMeshOf(imported);
  std::vector<double> heights;
  for (const v1::Region& region : body.regions()) {
    if (region.name() != body.constraints(constraint).region()) continue;
    for (std::size_t p = 0; p < mesh.node_tags.size(); ++p) {
      if (mesh.node_tags[p] != region.physical_tag()) continue;
      heights.push_back(mesh.nodes[static_cast<std::size_t>(mesh.tagged_nodes[p])][2]);
    }
  }
  return heights;
}

const char* kAllFixed =
    "<Rigid><rigid_bc type=\"rigid_fixed\"><rb>bone</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Rz_dof>1</Rz_dof>"
    "<Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof></rigid_bc></Rigid>";

TEST(FebioRigidTest, AFixedBodyHoldsTheNodesOfDeformableParts) {
  Pieces pieces = WithRigidPart();
  pieces.rest = kAllFixed;
  // A load on the rigid part changes nothing.
  pieces.sets += "<Surface name=\"outside\"><tri3 id=\"1\">2,3,5</tri3></Surface>";
  pieces.loads =
      "<surface_load type=\"pressure\" surface=\"outside\"><pressure>1</pressure><linear>1</linear></surface_load>";
  const ImportedScene imported = Import(pieces);
  EXPECT_EQ(
      NoticesOf(imported),
      "note model.feb:2: Loads/surface_load `pressure`: none of its facets belongs to a deformable part: it changes "
      "nothing\n");
  EXPECT_EQ(ImportedMeshOf(imported).tetrahedra.size(), 1u);
  ASSERT_EQ(imported.scene.bodies(0).constraints_size(), 1);
  EXPECT_EQ(imported.scene.bodies(0).constraints(0).axes_size(), 0);
  EXPECT_FALSE(imported.scene.bodies(0).constraints(0).has_motion());
  EXPECT_THAT(HeightsOf(imported, 0), ::testing::UnorderedElementsAre(0, 0, 10));
}

TEST(FebioRigidTest, AFreeBodyStopsTheImport) {
  Pieces pieces = WithRigidPart();
  pieces.rest =
      "<Rigid><rigid_bc type=\"rigid_fixed\"><rb>2</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Ru_dof>1</Ru_dof>"
      "<Rv_dof>1</Rv_dof></rigid_bc>\n<rigid_load type=\"rigid_force\"><rb>2</rb><dof>Rz</dof><value>3</value>"
      "</rigid_load></Rigid>";
  EXPECT_THAT(
      Refusal(pieces),
      HasSubstr("model.feb:2: Material/material `bone`: not supported: the rigid body moves freely along z, about "
                "z; a support has given motions only: its 3 nodes of deformable parts are free (fix or prescribe"));
  EXPECT_THAT(Refusal(pieces),
              HasSubstr("model.feb:3: Rigid/rigid_load `rigid_force`: not supported: acts on a rigid"));
  EXPECT_EQ(Import(pieces).scene.bodies(0).constraints_size(), 0);
  // A force on a body whose motion is given changes nothing.
  pieces.rest.replace(pieces.rest.find("<Ru_dof>"), 8, "<Rz_dof>1</Rz_dof><Rw_dof>1</Rw_dof><Ru_dof>");
  EXPECT_THAT(NoticesOf(Import(pieces)),
              HasSubstr("note model.feb:3: Rigid/rigid_load `rigid_force`: acts on a rigid"));
  pieces.rest = "<Rigid><rigid_bc type=\"rigid_euler_angles\"><rb>bone</rb></rigid_bc></Rigid>";
  EXPECT_THAT(Refusal(pieces), HasSubstr("the rigid constraint `rigid_euler_angles` is not supported"));
  pieces.rest = "<Rigid><rigid_connector type=\"rigid spring\"><body_a>bone</body_a></rigid_connector></Rigid>";
  EXPECT_THAT(Refusal(pieces), HasSubstr("rigid connectors are not supported"));
  pieces.rest = "<Rigid><rigid_bc type=\"rigid_fixed\"><rb>bome</rb><Rx_dof>1</Rx_dof></rigid_bc></Rigid>";
  EXPECT_THAT(Refusal(pieces), HasSubstr("there is no rigid body `bome`"));
}

// Displacements and a rotation about the centre of mass, which is the centroid of the rigid tetrahedron.
TEST(FebioRigidTest, MotionsTurnAboutTheCentreOfMass) {
  Pieces pieces = WithRigidPart();
  pieces.boundary = "<bc type=\"rigid\" node_set=\"t1\"><rb>bone</rb><clamp_shells>1</clamp_shells></bc>";
  pieces.sets += "<NodeSet name=\"t1\">1</NodeSet>";
  const std::string fixed =
      "<rigid_bc type=\"rigid_fixed\"><rb>bone</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Ru_dof>1</Ru_dof></rigid_bc>";
  const std::string lifted =
      "<rigid_bc type=\"rigid_displacement\"><rb>bone</rb><dof>z</dof><value lc=\"1\">3</value></rigid_bc>";
  const auto turned = [](const char* dof, const char* value) {
    return std::string("<rigid_bc type=\"rigid_rotation\"><rb>bone</rb><dof>") + dof + "</dof><value lc=\"1\">" +
           value + "</value></rigid_bc>";
  };
  pieces.rest = "<Rigid>" + fixed + lifted + turned("Rv", "0.3") + turned("Rw", "0.4") + "</Rigid>";
  ImportedScene imported = Import(pieces);
  EXPECT_EQ(NoticesOf(imported), "");
  ASSERT_EQ(imported.scene.bodies(0).constraints_size(), 1);
  const v1::Constraint constraint = imported.scene.bodies(0).constraints(0);
  EXPECT_EQ(HeightsOf(imported, 0).size(), 4u) << "the attached node, too";
  ASSERT_EQ(constraint.motion().translation_size(), 1);
  EXPECT_EQ(constraint.motion().translation(0).axis(), v1::AXIS_Z);
  EXPECT_NEAR(constraint.motion().translation(0).curve().values(1), 6e-3, 1e-15);
  const v1::Rotation& rotation = constraint.motion().rotation();
  EXPECT_THAT(rotation.point(), ElementsAre(5, 5, 5));
  EXPECT_THAT(rotation.axis(), ElementsAre(0, ::testing::DoubleEq(0.6), ::testing::DoubleEq(0.8)));
  EXPECT_THAT(rotation.angle().values(), ElementsAre(0, ::testing::DoubleEq(1)));
  // The same by a rotation vector, about a given centre.
  pieces.material.insert(pieces.material.rfind("</material>"), "<center_of_mass>1,2,3</center_of_mass>");
  pieces.rest =
      "<Rigid>" + fixed + lifted +
      "<rigid_bc type=\"rigid_rotation_vector\"><rb>bone</rb><vx>0</vx><vy lc=\"1\">0.3</vy><vz lc=\"1\">0.4</vz>"
      "</rigid_bc></Rigid>";
  imported = Import(pieces);
  EXPECT_THAT(imported.scene.bodies(0).constraints(0).motion().rotation().point(), ElementsAre(1, 2, 3));
  EXPECT_THAT(imported.scene.bodies(0).constraints(0).motion().rotation().angle().values(),
              ElementsAre(0, ::testing::DoubleEq(1)));
  // Rotations about several axes by different curves are no rotation about a line.
  pieces.rest = "<Rigid>" + fixed + lifted + turned("Rv", "0.3") +
                "<rigid_bc type=\"rigid_rotation\"><rb>bone</rb><dof>Rw</dof><value>1</value></rigid_bc></Rigid>";
  EXPECT_THAT(Refusal(pieces), HasSubstr("turns the body about several axes by different load curves"));
}

TEST(FebioRigidTest, BodiesWithoutElementsNeedACentreToTurn) {
  Pieces pieces;
  pieces.material += "<material id=\"2\" name=\"grip\" type=\"rigid body\"/>";
  pieces.boundary = "<bc type=\"rigid\" node_set=\"t\"><rb>grip</rb></bc>";
  pieces.rest =
      "<Rigid><rigid_bc type=\"rigid_fixed\"><rb>grip</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Rz_dof>1</Rz_dof>"
      "<Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof></rigid_bc><rigid_bc type=\"rigid_rotation\"><rb>grip</rb><dof>Rw</dof>"
      "<value lc=\"1\">0.1</value></rigid_bc></Rigid>";
  EXPECT_THAT(Refusal(pieces), HasSubstr("give <center_of_mass> of its material"));
  pieces.boundary += "<bc type=\"zero displacement\" node_set=\"t\"><z_dof>1</z_dof></bc>";
  pieces.material.replace(pieces.material.rfind("/>"), 2, "><center_of_mass>0,0,0</center_of_mass></material>");
  EXPECT_THAT(Refusal(pieces), HasSubstr("moves node 5 along z differently"));
}

// Shells are left out with the sets that name them, whatever their material.
TEST(FebioMeshTest, ShellsAreLeftOut) {
  Pieces pieces;
  pieces.material += "<material id=\"2\" name=\"fascia\" type=\"Fung orthotropic\"/>";
  pieces.nodes += "<node id=\"6\">0,0,-10</node>";
  pieces.elements +=
      "<Elements type=\"tri3\" name=\"skin\"><elem id=\"3\">1,2,3</elem><elem id=\"4\">1,2,6</elem></Elements>";
  pieces.domains += "<ShellDomain name=\"skin\" mat=\"fascia\"/>";
  pieces.sets += "<ElementSet name=\"e\">1,3,4</ElementSet><NodeSet name=\"edge\">6</NodeSet>";
  pieces.boundary += "<bc type=\"zero displacement\" node_set=\"edge\"><z_dof>1</z_dof></bc>";
  EXPECT_THAT(Refusal(pieces),
              HasSubstr("Mesh/Elements `skin`: not supported: elements of type `tri3` have no volume"));
  const ImportedScene imported = Import(pieces);
  EXPECT_EQ(ImportedMeshOf(imported).tetrahedra.size(), 2u);
  const std::string notices = NoticesOf(imported);
  EXPECT_THAT(notices, HasSubstr("note model.feb:1: Mesh/ElementSet `e`: 2 of its 3 elements are shells or beams"));
  EXPECT_THAT(notices, HasSubstr("note model.feb:1: Boundary/bc `zero displacement`: none of its nodes belongs to a"));
  // A rigid shell holds the nodes that it shares.
  pieces.material.replace(pieces.material.find("Fung orthotropic"), 16, "rigid body");
  pieces.rest = kAllFixed;
  pieces.rest.replace(pieces.rest.find("bone"), 4, "fascia");
  const ImportedScene held = Import(pieces);
  EXPECT_EQ(HeightsOf(held, held.scene.bodies(0).constraints_size() - 1).size(), 3u);
  EXPECT_THAT(NoticesOf(held), ::testing::Not(HasSubstr("unsupported")));
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
  options.accept_loss = true;
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
