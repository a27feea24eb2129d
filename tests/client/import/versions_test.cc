// Three models, each as versions 2.5, 3.0 and 4.0 write it: the same scene follows from all of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/import/febio_import.h"
#include "client/lib/scene_json.h"

namespace fascicle::testing {
namespace {

using client::ImportedScene;
using client::Notice;

struct Written {
  const char *two, *three, *four;
};

// A muscle between two bones. The upper one is a rigid part of hexahedra that is lifted and turned; the lower one has
// no elements, and holds a node set.
constexpr const char* kBonesNodes = R"(
    <Nodes name="all">
      <node id="1">0,0,0</node><node id="2">10,0,0</node><node id="3">10,10,0</node><node id="4">0,10,0</node>
      <node id="5">0,0,10</node><node id="6">10,0,10</node><node id="7">10,10,10</node><node id="8">0,10,10</node>
      <node id="9">0,0,20</node><node id="10">10,0,20</node><node id="11">10,10,20</node><node id="12">0,10,20</node>
    </Nodes>)";
constexpr const char* kBonesMuscle = R"(
      <elem id="1">1,2,4,5</elem><elem id="2">2,3,4,7</elem><elem id="3">5,7,6,2</elem><elem id="4">5,8,7,4</elem>
      <elem id="5">2,4,5,7</elem>)";
constexpr const char* kBonesMaterials = R"(
    <material id="1" name="muscle" type="uncoupled solid mixture">
      <k>8</k>
      <solid type="Mooney-Rivlin"><c1>0.03</c1><c2>0.01</c2></solid>
      <solid type="muscle material">
        <g1>0</g1><g2>0</g2><p1>0.05</p1><p2>6.6</p2><smax>0.3</smax><Lofl>1.07</Lofl><lam_max>1.4</lam_max>
        <activation lc="2">1</activation>
        <fiber type="local">1,2</fiber>
      </solid>
    </material>
    <material id="2" name="upper" type="rigid body"><density>1e-9</density></material>
    <material id="3" name="lower" type="rigid body"><density>1e-9</density><center_of_mass>5,5,0</center_of_mass></material>)";

const std::string kBonesTwo = std::string(R"(<?xml version="1.0"?>
<febio_spec version="2.5">
  <Module type="solid"/>
  <Control><analysis type="static"/><time_steps>10</time_steps><step_size>0.1</step_size>
    <max_refs>15</max_refs><time_stepper><dtmin>0.01</dtmin><dtmax>0.1</dtmax></time_stepper></Control>
  <Material>)") + kBonesMaterials +
                              R"(</Material>
  <Geometry>)" + kBonesNodes + R"(
    <Elements type="tet4" mat="1" name="belly">)" +
                              kBonesMuscle + R"(</Elements>
    <Elements type="hex8" mat="2"><elem id="6">5,6,7,8,9,10,11,12</elem></Elements>
    <NodeSet name="base"><node id="1"/><node id="2"/><node id="3"/><node id="4"/></NodeSet>
  </Geometry>
  <Boundary>
    <rigid rb="3" node_set="base"/>
    <rigid_body mat="3"><fixed bc="x"/><fixed bc="y"/><fixed bc="z"/><fixed bc="Rx"/><fixed bc="Ry"/><fixed bc="Rz"/></rigid_body>
    <rigid_body mat="2"><fixed bc="x"/><fixed bc="y"/><prescribed bc="z" lc="1">2</prescribed>
      <fixed bc="Rx"/><prescribed bc="Ry" lc="1">0.25</prescribed><fixed bc="Rz"/></rigid_body>
  </Boundary>
  <LoadData>
    <loadcurve id="1" type="linear"><point>0,0</point><point>1,1</point></loadcurve>
    <loadcurve id="2" type="smooth" extend="constant"><point>0,0</point><point>0.5,1</point><point>1,0.5</point></loadcurve>
  </LoadData>
  <Output><plotfile type="febio"><var type="stress"/></plotfile></Output>
</febio_spec>)";

const std::string kBonesThree = std::string(R"(<?xml version="1.0"?>
<febio_spec version="3.0">
  <Module type="solid"/>
  <Control><analysis>static</analysis><time_steps>10</time_steps><step_size>0.1</step_size>
    <solver><max_refs>15</max_refs></solver></Control>
  <Material>)") + kBonesMaterials +
                                R"(</Material>
  <Mesh>)" + kBonesNodes + R"(
    <Elements type="tet4" name="belly">)" +
                                kBonesMuscle + R"(</Elements>
    <Elements type="hex8" name="bone"><elem id="6">5,6,7,8,9,10,11,12</elem></Elements>
    <NodeSet name="base"><n id="1"/><n id="2"/><n id="3"/><n id="4"/></NodeSet>
  </Mesh>
  <MeshDomains><SolidDomain name="belly" mat="muscle"/><SolidDomain name="bone" mat="upper"/></MeshDomains>
  <Boundary><bc name="base" type="rigid" node_set="base"><rb>lower</rb></bc></Boundary>
  <Rigid>
    <rigid_constraint name="a" type="fix"><rb>3</rb><dofs>Rx,Ry,Rz,Ru,Rv,Rw</dofs></rigid_constraint>
    <rigid_constraint name="b" type="fix"><rb>2</rb><dofs>Rx,Ry,Ru,Rw</dofs></rigid_constraint>
    <rigid_constraint name="c" type="prescribe"><rb>2</rb><dof>Rz</dof><value lc="1">2</value><relative>0</relative></rigid_constraint>
    <rigid_constraint name="d" type="prescribe"><rb>2</rb><dof>Rv</dof><value lc="1">0.25</value><relative>0</relative></rigid_constraint>
  </Rigid>
  <LoadData>
    <load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><points><point>0,0</point><point>1,1</point></points></load_controller>
    <load_controller id="2" type="loadcurve"><interpolate>SMOOTH</interpolate><extend>CONSTANT</extend><points><point>0,0</point><point>0.5,1</point><point>1,0.5</point></points></load_controller>
  </LoadData>
</febio_spec>)";

std::string BonesFour() {
  std::string text = kBonesThree;
  const auto replace = [&](const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    text.replace(at, what.size(), by);
  };
  replace("version=\"3.0\"", "version=\"4.0\"");
  replace("<fiber type=\"local\">1,2</fiber>", "<fiber type=\"local\"><local>1,2</local></fiber>");
  replace("<n id=\"1\"/><n id=\"2\"/><n id=\"3\"/><n id=\"4\"/>", "1,2,3,4");
  const std::size_t begin = text.find("  <Rigid>"), end = text.find("</Rigid>");
  text.replace(begin, end - begin, R"(  <Rigid>
    <rigid_bc name="a" type="rigid_fixed"><rb>lower</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Rz_dof>1</Rz_dof>
      <Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof></rigid_bc>
    <rigid_bc name="b" type="rigid_fixed"><rb>upper</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Rz_dof>0</Rz_dof>
      <Ru_dof>1</Ru_dof><Rv_dof>0</Rv_dof><Rw_dof>1</Rw_dof></rigid_bc>
    <rigid_bc name="c" type="rigid_displacement"><rb>upper</rb><dof>z</dof><value lc="1">2</value><relative>0</relative></rigid_bc>
    <rigid_bc name="d" type="rigid_rotation"><rb>upper</rb><dof>Rv</dof><value lc="1">0.25</value><relative>0</relative></rigid_bc>
  )");
  return text;
}

// A tendon whose fibres lie around a line, pulled by nodal forces and a traction, in a dynamic analysis without units.
constexpr const char* kTendonNodes = R"(
    <Nodes name="all">
      <node id="1">0,0,0</node><node id="2">2,0,0</node><node id="3">0,2,0</node><node id="4">0,0,3</node><node id="5">2,2,3</node>
    </Nodes>)";
constexpr const char* kTendonElements = R"(<elem id="1">1,2,3,4</elem><elem id="2">2,3,4,5</elem>)";
constexpr const char* kTendonMaterial = R"(
    <material id="1" name="tendon" type="trans iso Mooney-Rivlin">
      <density>1</density><c1>50</c1><c2>1</c2><c3>20</c3><c4>8</c4><c5>0</c5><lam_max>1.2</lam_max><k>5000</k>
      <fiber type="cylindrical"><center>-1,0,0</center><axis>0,0,1</axis><vector>0,0,1</vector></fiber>
    </material>)";
constexpr const char* kTendonTraction =
    "<surface_load type=\"traction\" surface=\"side\"><scale "
    "lc=\"2\">3</scale><traction>0,0,1</traction><linear>1</linear>"
    "</surface_load>";

const Written kTendon = {
    R"(<febio_spec version="2.5">
  <Module type="solid"/>
  <Control><analysis type="dynamic"/><time_steps>20</time_steps><step_size>0.05</step_size></Control>
  <Material>MATERIAL</Material>
  <Geometry>NODES
    <Elements type="tet4" mat="1" name="t">ELEMENTS</Elements>
    <NodeSet name="low"><node id="1"/><node id="2"/><node id="3"/></NodeSet>
    <NodeSet name="high"><node id="5"/></NodeSet>
    <Surface name="side"><tri3 id="1">1,2,4</tri3></Surface>
  </Geometry>
  <Boundary><fix bc="x,y,z" node_set="low"/><prescribe bc="y" node_set="high"><scale lc="1">0.1</scale><relative>0</relative></prescribe></Boundary>
  <Loads><nodal_load bc="z" node_set="high"><scale lc="2">7</scale></nodal_load>TRACTION
    <body_load type="const"><z lc="1">981</z></body_load></Loads>
  <LoadData>
    <loadcurve id="1" type="step" extend="constant"><point>0,0</point><point>0.5,1</point></loadcurve>
    <loadcurve id="2" type="linear" extend="repeat"><point>0,0</point><point>0.25,1</point><point>0.5,0</point></loadcurve>
  </LoadData>
</febio_spec>)",
    R"(<febio_spec version="3.0">
  <Module type="solid"/>
  <Control><analysis>DYNAMIC</analysis><time_steps>20</time_steps><step_size>0.05</step_size></Control>
  <Material>MATERIAL</Material>
  <Mesh>NODES
    <Elements type="tet4" name="t">ELEMENTS</Elements>
    <NodeSet name="low"><n id="1"/><n id="2"/><n id="3"/></NodeSet>
    <NodeSet name="high"><n id="5"/></NodeSet>
    <Surface name="side"><tri3 id="1">1,2,4</tri3></Surface>
  </Mesh>
  <MeshDomains><SolidDomain name="t" mat="tendon"/></MeshDomains>
  <Boundary><bc type="fix" node_set="low"><dofs>x,y,z</dofs></bc>
    <bc type="prescribe" node_set="high"><dof>y</dof><scale lc="1">0.1</scale><relative>0</relative></bc></Boundary>
  <Loads><nodal_load type="nodal_load" node_set="high"><dof>z</dof><scale lc="2">7</scale></nodal_load>TRACTION
    <body_load type="const"><z lc="1">981</z></body_load></Loads>
  <LoadData>
    <load_controller id="1" type="loadcurve"><interpolate>STEP</interpolate><extend>CONSTANT</extend><points><point>0,0</point><point>0.5,1</point></points></load_controller>
    <load_controller id="2" type="loadcurve"><interpolate>LINEAR</interpolate><extend>REPEAT</extend><points><point>0,0</point><point>0.25,1</point><point>0.5,0</point></points></load_controller>
  </LoadData>
</febio_spec>)",
    R"(<febio_spec version="4.0">
  <Module type="solid"/>
  <Control><analysis>DYNAMIC</analysis><time_steps>20</time_steps><step_size>0.05</step_size></Control>
  <Material>MATERIAL</Material>
  <Mesh>NODES
    <Elements type="tet4" name="t">ELEMENTS</Elements>
    <NodeSet name="low">1,2,3</NodeSet>
    <NodeSet name="high">5</NodeSet>
    <Surface name="side"><tri3 id="1">1,2,4</tri3></Surface>
  </Mesh>
  <MeshDomains><SolidDomain name="t" mat="tendon" type="elastic-solid"/></MeshDomains>
  <Boundary><bc type="zero displacement" node_set="low"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>
    <bc type="prescribed displacement" node_set="high"><dof>y</dof><value lc="1">0.1</value><relative>0</relative></bc></Boundary>
  <Loads><nodal_load type="nodal_force" node_set="high"><value lc="2">0,0,7</value></nodal_load>TRACTION
    <body_load type="body force"><force lc="1">0,0,981</force></body_load></Loads>
  <LoadData>
    <load_controller id="1" type="loadcurve"><interpolate>STEP</interpolate><extend>CONSTANT</extend><points><pt>0,0</pt><pt>0.5,1</pt></points></load_controller>
    <load_controller id="2" type="loadcurve"><interpolate>LINEAR</interpolate><extend>REPEAT</extend><points><pt>0,0</pt><pt>0.25,1</pt><pt>0.5,0</pt></points></load_controller>
  </LoadData>
</febio_spec>)"};

// Two materials with shells between them that an element set names; fibres of a set by element data; one step.
const Written kLayers = {
    R"(<febio_spec version="2.5">
  <Module type="solid"/>
  <Material>MATERIAL</Material>
  <Geometry>NODES
    <Elements type="tet4" mat="1" name="a"><elem id="1">1,2,3,4</elem></Elements>
    <Elements type="tet4" mat="2" name="b"><elem id="2">2,3,4,5</elem></Elements>
    <Elements type="tri3" mat="3" name="skin"><elem id="3">1,2,3</elem></Elements>
    <NodeSet name="high"><node id="5"/></NodeSet>
    <ElementSet name="some"><elem id="2"/><elem id="3"/></ElementSet>
  </Geometry>
  <MeshData><ElementData var="fiber" elem_set="some"><elem lid="1">0,3,4</elem></ElementData></MeshData>
  <Step name="Step1">
    <Control><analysis type="static"/><time_steps>4</time_steps><step_size>0.25</step_size></Control>
    <Boundary>
      <rigid_body mat="3"><fixed bc="x"/><fixed bc="y"/><fixed bc="z"/><fixed bc="Rx"/><fixed bc="Ry"/><fixed bc="Rz"/></rigid_body>
      <prescribe bc="z" node_set="high"><scale lc="1">0.2</scale></prescribe>
    </Boundary>
  </Step>
  <LoadData><loadcurve id="1" type="linear" extend="extrapolate"><point>0,0</point><point>0.5,1</point></loadcurve></LoadData>
</febio_spec>)",
    R"(<febio_spec version="3.0">
  <Module type="solid"/>
  <Material>MATERIAL</Material>
  <Mesh>NODES
    <Elements type="tet4" name="a"><elem id="1">1,2,3,4</elem></Elements>
    <Elements type="tet4" name="b"><elem id="2">2,3,4,5</elem></Elements>
    <Elements type="tri3" name="skin"><elem id="3">1,2,3</elem></Elements>
    <NodeSet name="high"><n id="5"/></NodeSet>
    <ElementSet name="some"><e id="2"/><e id="3"/></ElementSet>
  </Mesh>
  <MeshDomains><SolidDomain name="a" mat="soft"/><SolidDomain name="b" mat="fibres"/><ShellDomain name="skin" mat="skin"/></MeshDomains>
  <MeshData><ElementData var="fiber" elem_set="some"><e lid="1">0,3,4</e></ElementData></MeshData>
  <Step><step id="1" name="Step1">
    <Control><analysis>STATIC</analysis><time_steps>4</time_steps><step_size>0.25</step_size></Control>
    <Rigid><rigid_constraint type="fix"><rb>skin</rb><dofs>Rx,Ry,Rz,Ru,Rv,Rw</dofs></rigid_constraint></Rigid>
    <Boundary><bc type="prescribe" node_set="high"><dof>z</dof><scale lc="1">0.2</scale></bc></Boundary>
  </step></Step>
  <LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><extend>EXTRAPOLATE</extend><points><point>0,0</point><point>0.5,1</point></points></load_controller></LoadData>
</febio_spec>)",
    R"(<febio_spec version="4.0">
  <Module type="solid"/>
  <Material>MATERIAL</Material>
  <Mesh>NODES
    <Elements type="tet4" name="a"><elem id="1">1,2,3,4</elem></Elements>
    <Elements type="tet4" name="b"><elem id="2">2,3,4,5</elem></Elements>
    <Elements type="tri3" name="skin"><elem id="3">1,2,3</elem></Elements>
    <NodeSet name="high">5</NodeSet>
    <ElementSet name="some">2,3</ElementSet>
  </Mesh>
  <MeshDomains><SolidDomain name="a" mat="soft"/><SolidDomain name="b" mat="fibres"/><ShellDomain name="skin" mat="skin"/></MeshDomains>
  <MeshData><ElementData type="fiber" elem_set="some"><elem lid="1">0,3,4</elem></ElementData></MeshData>
  <Step><step id="1" name="Step1">
    <Control><analysis>STATIC</analysis><time_steps>4</time_steps><step_size>0.25</step_size></Control>
    <Rigid><rigid_bc type="rigid_fixed"><rb>skin</rb><Rx_dof>1</Rx_dof><Ry_dof>1</Ry_dof><Rz_dof>1</Rz_dof><Ru_dof>1</Ru_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof></rigid_bc></Rigid>
    <Boundary><bc type="prescribed displacement" node_set="high"><dof>z</dof><value lc="1">0.2</value></bc></Boundary>
  </step></Step>
  <LoadData><load_controller id="1" type="loadcurve"><interpolate>LINEAR</interpolate><extend>EXTRAPOLATE</extend><points><pt>0,0</pt><pt>0.5,1</pt></points></load_controller></LoadData>
</febio_spec>)"};
constexpr const char* kLayersMaterial = R"(
    <material id="1" name="soft" type="neo-Hookean"><E>1</E><v>0.3</v></material>
    <material id="2" name="fibres" type="trans iso Mooney-Rivlin"><c1>1</c1><k>100</k><c3>0.2</c3><c4>30</c4><c5>5</c5><lam_max>1.05</lam_max></material>
    <material id="3" name="skin" type="rigid body"/>)";

std::string Filled(std::string text, const std::vector<std::pair<std::string, std::string>>& pieces) {
  for (const auto& [what, by] : pieces) {
    const std::size_t at = text.find(what);
    if (at != std::string::npos) text.replace(at, what.size(), by);
  }
  return text;
}

ImportedScene ImportWhole(const std::string& model) {
  Problems problems;
  auto imported = client::ImportFebio(model, {}, problems);
  EXPECT_TRUE(imported.has_value()) << problems.ToString();
  return imported ? *imported : ImportedScene();
}

// The scenes and files are the same to the last bit; returns one of them.
ImportedScene ExpectSame(const std::vector<std::string>& models) {
  std::vector<ImportedScene> scenes;
  for (const std::string& model : models) scenes.push_back(ImportWhole(model));
  for (const ImportedScene& other : scenes) {
    EXPECT_EQ(client::JsonText(other.scene), client::JsonText(scenes[0].scene)) << other.version;
    EXPECT_EQ(other.units, scenes[0].units);
    EXPECT_EQ(other.files.size(), scenes[0].files.size());
    for (std::size_t f = 0; f < std::min(other.files.size(), scenes[0].files.size()); ++f) {
      EXPECT_EQ(other.files[f].bytes, scenes[0].files[f].bytes) << other.version;
    }
    for (const Notice& notice : other.notices) EXPECT_FALSE(notice.is_loss()) << notice.where << notice.message;
  }
  return scenes[0];
}

TEST(FebioVersionsTest, AMuscleBetweenBones) {
  const ImportedScene imported = ExpectSame({kBonesTwo, kBonesThree, BonesFour()});
  const v1::Body& body = imported.scene.bodies(0);
  EXPECT_EQ(body.name(), "belly");
  ASSERT_EQ(body.constraints_size(), 2);
  EXPECT_EQ(body.constraints(0).region(), "rigid_upper");
  EXPECT_EQ(body.constraints(1).region(), "rigid_lower");
  EXPECT_NEAR(body.constraints(0).motion().translation(0).curve().values(1), 2e-3, 1e-15);
  const v1::Rotation& rotation = body.constraints(0).motion().rotation();
  EXPECT_THAT(rotation.point(), ::testing::ElementsAre(::testing::DoubleNear(5, 1e-12), ::testing::DoubleNear(5, 1e-12),
                                                       ::testing::DoubleNear(15, 1e-12)));
  EXPECT_THAT(rotation.axis(), ::testing::ElementsAre(0, 1, 0));
  EXPECT_EQ(rotation.angle().values(1), 0.25);
  EXPECT_FALSE(body.constraints(1).has_motion());
  EXPECT_GT(body.activation().times_size(), 40) << "a smooth curve";
}

TEST(FebioVersionsTest, ATendonUnderLoads) {
  std::vector<std::string> models;
  for (const char* text : {kTendon.two, kTendon.three, kTendon.four}) {
    models.push_back(Filled(text, {{"MATERIAL", kTendonMaterial},
                                   {"NODES", kTendonNodes},
                                   {"ELEMENTS", kTendonElements},
                                   {"TRACTION", kTendonTraction}}));
  }
  const ImportedScene imported = ExpectSame(models);
  EXPECT_EQ(imported.units, "CGS");
  const v1::Body& body = imported.scene.bodies(0);
  EXPECT_EQ(body.density(), 1000);
  EXPECT_EQ(imported.scene.tet().stepping(), v1::STEPPING_NEWMARK);
  EXPECT_THAT(body.fibres().constant().direction(), ::testing::ElementsAre(0, 0, 1));
  EXPECT_NEAR(imported.scene.gravity().acceleration(2), -9.81, 1e-12);
  ASSERT_EQ(body.loads_size(), 2);
  EXPECT_NEAR(body.loads(0).nodal_force().total(2), 7e-5, 1e-15);
  EXPECT_THAT(body.loads(0).scale().values(), ::testing::ElementsAre(0, 1, 0, 1, 0));
  EXPECT_NEAR(body.loads(1).traction().vector(2), 0.3, 1e-12);
}

TEST(FebioVersionsTest, LayersWithARigidSkin) {
  std::vector<std::string> models;
  for (const char* text : {kLayers.two, kLayers.three, kLayers.four}) {
    models.push_back(Filled(text, {{"MATERIAL", kLayersMaterial}, {"NODES", kTendonNodes}}));
  }
  const ImportedScene imported = ExpectSame(models);
  const v1::Body& body = imported.scene.bodies(0);
  ASSERT_EQ(body.region_materials_size(), 1);
  EXPECT_TRUE(body.region_materials(0).material().has_trans_iso_mooney_rivlin());
  ASSERT_EQ(body.constraints_size(), 2);
  EXPECT_NEAR(body.constraints(0).motion().translation(0).curve().values(2), 0.4e-3, 1e-15);
  EXPECT_EQ(body.constraints(1).axes_size(), 0);
  EXPECT_THAT(imported.files.back().bytes, ::testing::HasSubstr("1 0 0\n0 0.6"));
}

}  // namespace
}  // namespace fascicle::testing
