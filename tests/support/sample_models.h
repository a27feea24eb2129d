#ifndef FASCICLE_TESTS_SUPPORT_SAMPLE_MODELS_H_
#define FASCICLE_TESTS_SUPPORT_SAMPLE_MODELS_H_

// Models for tests, and the first corpus of the importer's fuzz target.
namespace fascicle::testing {

// Two tetrahedra with a common side, fixed below and pulled above.
inline constexpr const char* kSmallModel = R"(<?xml version="1.0" encoding="ISO-8859-1"?>
<febio_spec version="4.0">
  <Module type="solid"/>
  <Control>
    <analysis>STATIC</analysis>
    <time_steps>10</time_steps>
    <step_size>0.1</step_size>
  </Control>
  <Material>
    <material id="1" name="rubber" type="Mooney-Rivlin">
      <c1>0.03</c1>
      <c2>0.01</c2>
      <k>80</k>
    </material>
  </Material>
  <Mesh>
    <Nodes name="all">
      <node id="1">0,0,0</node>
      <node id="2">10,0,0</node>
      <node id="3">0,10,0</node>
      <node id="4">0,0,10</node>
      <node id="5">10,10,10</node>
    </Nodes>
    <Elements type="tet4" name="block">
      <elem id="1">1,2,3,4</elem>
      <elem id="2">2,3,4,5</elem>
    </Elements>
    <NodeSet name="bottom">1,2,3</NodeSet>
    <NodeSet name="top">5</NodeSet>
    <Surface name="side">
      <tri3 id="1">1,3,2</tri3>
    </Surface>
  </Mesh>
  <MeshDomains>
    <SolidDomain name="block" mat="rubber"/>
  </MeshDomains>
  <Boundary>
    <bc type="zero displacement" node_set="bottom">
      <x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof>
    </bc>
    <bc type="prescribed displacement" node_set="top">
      <dof>z</dof>
      <value lc="1">1.0</value>
    </bc>
  </Boundary>
  <Loads>
    <nodal_load type="nodal_load" node_set="top">
      <dof>x</dof>
      <scale lc="1">0.1</scale>
    </nodal_load>
    <surface_load type="traction" surface="side">
      <scale lc="1">1</scale>
      <traction>0,0,0.001</traction>
      <linear>1</linear>
    </surface_load>
  </Loads>
  <LoadData>
    <load_controller id="1" type="loadcurve">
      <interpolate>LINEAR</interpolate>
      <points>
        <pt>0,0</pt>
        <pt>1,1</pt>
      </points>
    </load_controller>
  </LoadData>
</febio_spec>
)";

// A muscle of hexahedra, a wedge and a tendon of tetrahedra, with most features of a model.
inline constexpr const char* kRichModel = R"(<febio_spec version="3.0">
  <Module type="solid"><units>mm-N-s</units></Module>
  <Control>
    <analysis>DYNAMIC</analysis><time_steps>4</time_steps><step_size>0.25</step_size><plot_stride>2</plot_stride>
    <solver><rhoi>0</rhoi></solver>
  </Control>
  <Material>
    <material id="1" name="muscle" type="uncoupled solid mixture">
      <density>1e-9</density><k>8</k>
      <mat_axis type="local">1,2,4</mat_axis>
      <solid type="Mooney-Rivlin"><c1>0.03</c1><c2>0.01</c2></solid>
      <solid type="muscle material">
        <g1>0</g1><g2>0</g2><p1>0.05</p1><p2>6.6</p2><Lofl>1</Lofl><smax>0.3</smax><lam_max>1.4</lam_max>
        <activation lc="2">1</activation><fiber type="angles"><theta>10</theta><phi>80</phi></fiber>
      </solid>
    </material>
    <material id="2" name="tendon" type="trans iso Mooney-Rivlin">
      <density>1e-9</density><c1>1</c1><c2>0</c2><c3>0.2</c3><c4>30</c4><c5>5</c5><lam_max>1.05</lam_max><k>100</k>
      <fiber type="map">along</fiber>
    </material>
    <material id="3" name="bone" type="rigid body"/>
  </Material>
  <Mesh>
    <Nodes name="all">
      <node id="1">0,0,0</node><node id="2">10,0,0</node><node id="3">10,10,0</node><node id="4">0,10,0</node>
      <node id="5">0,0,10</node><node id="6">10,0,10</node><node id="7">10,10,10</node><node id="8">0,10,10</node>
      <node id="9">20,5,0</node><node id="10">20,5,10</node><node id="11">30,5,5</node>
    </Nodes>
    <Elements type="hex8" name="belly"><elem id="1">1,2,3,4,5,6,7,8</elem></Elements>
    <Elements type="penta6" name="end"><elem id="2">2,9,3,6,10,7</elem></Elements>
    <Elements type="tet4" name="tip"><elem id="3">3,10,9,11</elem></Elements>
    <NodeSet name="left"><n id="1"/><n id="4"/><n id="5"/><n id="8"/></NodeSet>
    <Surface name="below"><quad4 id="1">1,4,3,2</quad4></Surface>
    <ElementSet name="tendons">2,3</ElementSet>
  </Mesh>
  <MeshDomains>
    <SolidDomain name="belly" mat="muscle"/><SolidDomain name="end" mat="tendon"/><SolidDomain name="tip" mat="2"/>
  </MeshDomains>
  <MeshData>
    <ElementData name="along" data_type="vec3" elem_set="tendons">
      <elem lid="1">1,0,0</elem><elem lid="2">1,0.1,0</elem>
    </ElementData>
  </MeshData>
  <Boundary>
    <bc type="fix" node_set="left"><dofs>x,y,z</dofs></bc>
    <bc type="prescribe" node_set="@elem_set:tip"><dof>x</dof><scale lc="1">0.1</scale><relative>0</relative></bc>
    <bc type="rigid" node_set="left"><rb>3</rb></bc>
  </Boundary>
  <Loads>
    <surface_load type="pressure" surface="below"><pressure lc="1">0.01</pressure></surface_load>
    <surface_load type="traction" surface="below"><scale lc="3">2</scale><traction>0,0,0.1</traction></surface_load>
    <nodal_load type="nodal_force" node_set="left"><value>0,0,1</value></nodal_load>
    <body_load type="const"><z lc="1">9810</z></body_load>
  </Loads>
  <LoadData>
    <load_controller id="1" type="loadcurve"><interpolate>SMOOTH</interpolate><extend>EXTRAPOLATE</extend>
      <points><pt>0,0</pt><pt>0.5,0.4</pt><pt>1,1</pt></points></load_controller>
    <load_controller id="2" type="loadcurve"><interpolate>STEP</interpolate>
      <points><pt>0,0</pt><pt>0.5,0.4</pt><pt>1,1</pt></points></load_controller>
    <load_controller id="3" type="loadcurve"><interpolate>SMOOTH STEP</interpolate>
      <points><pt>-1,0</pt><pt>1,1</pt></points></load_controller>
  </LoadData>
  <Contact><contact type="sliding-elastic"/></Contact>
</febio_spec>
)";

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_SAMPLE_MODELS_H_
