#ifndef FASCICLE_TESTS_SUPPORT_SAMPLE_OSIM_H_
#define FASCICLE_TESTS_SUPPORT_SAMPLE_OSIM_H_

namespace fascicle::testing {

// A small OpenSim model of version 4: two bones, a hinge and a custom joint, a wrapped muscle and one with a moving
// point.
inline const char kSmallOsim[] = R"(<?xml version="1.0" encoding="UTF-8"?>
<OpenSimDocument Version="40000">
<Model name="small arm">
<gravity>0 -9.81 0</gravity>
<BodySet><objects>
<Body name="upper arm">
<attached_geometry><Mesh name="m"><mesh_file>upper.obj</mesh_file><scale_factors>1 1 2</scale_factors></Mesh></attached_geometry>
<WrapObjectSet><objects>
<WrapCylinder name="elbow"><xyz_body_rotation>0 0.1 0</xyz_body_rotation><translation>0 -0.3 0</translation>
<quadrant>x</quadrant><radius>0.02</radius><length>0.1</length></WrapCylinder>
</objects></WrapObjectSet>
<mass>1.5</mass><mass_center>0 -0.15 0</mass_center><inertia>0.01 0.002 0.01 0 0 0</inertia>
</Body>
<Body name="forearm">
<mass>2</mass><mass_center>0 -0.15 0</mass_center><inertia>0.02 0.002 0.02 0 0 0</inertia>
</Body>
</objects></BodySet>
<JointSet><objects>
<PinJoint name="shoulder">
<socket_parent_frame>/ground</socket_parent_frame><socket_child_frame>/bodyset/upper arm</socket_child_frame>
<coordinates><Coordinate name="shoulder"><default_value>0.2</default_value><range>-1 2</range></Coordinate></coordinates>
</PinJoint>
<CustomJoint name="elbow">
<socket_parent_frame>upper_offset</socket_parent_frame><socket_child_frame>/bodyset/forearm</socket_child_frame>
<coordinates><Coordinate name="elbow"><range>0 2</range></Coordinate></coordinates>
<frames><PhysicalOffsetFrame name="upper_offset"><socket_parent>/bodyset/upper arm</socket_parent>
<translation>0 -0.3 0</translation><orientation>0 0.1 0</orientation></PhysicalOffsetFrame></frames>
<SpatialTransform>
<TransformAxis name="rotation1"><coordinates>elbow</coordinates><axis>0 0 1</axis>
<function><LinearFunction><coefficients>1 0</coefficients></LinearFunction></function></TransformAxis>
<TransformAxis name="rotation2"><axis>0 1 0</axis><function><Constant><value>0</value></Constant></function></TransformAxis>
<TransformAxis name="rotation3"><axis>1 0 0</axis><function><Constant><value>0</value></Constant></function></TransformAxis>
<TransformAxis name="translation1"><coordinates>elbow</coordinates><axis>1 0 0</axis>
<function><SimmSpline><x>0 0.5 1 2</x><y>0 0.002 0.003 0.001</y></SimmSpline></function></TransformAxis>
<TransformAxis name="translation2"><axis>0 1 0</axis><function><Constant><value>0.01</value></Constant></function></TransformAxis>
<TransformAxis name="translation3"><axis>0 0 1</axis><function><Constant><value>0</value></Constant></function></TransformAxis>
</SpatialTransform>
</CustomJoint>
</objects></JointSet>
<ForceSet><objects>
<Thelen2003Muscle name="flexor">
<GeometryPath><PathPointSet><objects>
<PathPoint name="1"><socket_parent_frame>/bodyset/upper arm</socket_parent_frame><location>0.02 -0.05 0</location></PathPoint>
<PathPoint name="2"><socket_parent_frame>/bodyset/forearm</socket_parent_frame><location>0.01 -0.05 0</location></PathPoint>
</objects></PathPointSet>
<PathWrapSet><objects><PathWrap name="w"><wrap_object>elbow</wrap_object><range>-1 -1</range></PathWrap></objects></PathWrapSet>
</GeometryPath>
<max_isometric_force>800</max_isometric_force><optimal_fiber_length>0.1</optimal_fiber_length>
<tendon_slack_length>0.2</tendon_slack_length><pennation_angle_at_optimal>0.1</pennation_angle_at_optimal>
</Thelen2003Muscle>
<Thelen2003Muscle name="extensor">
<GeometryPath><PathPointSet><objects>
<PathPoint name="1"><socket_parent_frame>/ground</socket_parent_frame><location>-0.02 0.05 0</location></PathPoint>
<MovingPathPoint name="2"><socket_parent_frame>/bodyset/forearm</socket_parent_frame>
<socket_x_coordinate>/jointset/elbow/elbow</socket_x_coordinate><socket_y_coordinate>/jointset/elbow/elbow</socket_y_coordinate>
<socket_z_coordinate>/jointset/elbow/elbow</socket_z_coordinate>
<x_location><PiecewiseLinearFunction><x>0 2</x><y>-0.03 -0.02</y></PiecewiseLinearFunction></x_location>
<y_location><Constant><value>0.01</value></Constant></y_location>
<z_location><Constant><value>0</value></Constant></z_location></MovingPathPoint>
</objects></PathPointSet></GeometryPath>
<max_isometric_force>900</max_isometric_force>
</Thelen2003Muscle>
</objects></ForceSet>
</Model>
</OpenSimDocument>
)";

// A motion of its elbow.
inline const char kSmallMotion[] = R"(flexion
nRows=5
nColumns=2
inDegrees=yes
endheader
time	elbow
0	10
0.1	20
0.2	40
0.3	70
0.4	80
)";

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_SAMPLE_OSIM_H_
