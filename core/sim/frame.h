#ifndef FASCICLE_CORE_SIM_FRAME_H_
#define FASCICLE_CORE_SIM_FRAME_H_

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/digest.h"
#include "core/base/pose.h"
#include "core/base/types.h"
#include "core/geometry/triangle_mesh.h"
#include "core/scene/output_fields.h"

namespace fascicle {

struct FieldValues {
  std::string name;  // `velocity`, `cauchy_stress`, ... as in scene.proto
  FieldLocation location = FieldLocation::kNode;
  int components = 1;
  std::string unit;
  std::vector<double> values;  // component fastest
  // Of a field at nodes, if the body has higher-order nodes: the values at all nodes, first those of the mesh. Forces
  // there are those on the nodes themselves; `values` has those on a mid-edge node halved between the ends of its edge.
  std::vector<double> all_values = {};
};

// A field with its values at a location (LocationOf).
FieldValues FieldOf(OutputField field, FieldLocation location, std::vector<double> values);

struct BodyFrame {
  std::vector<Vec3> positions;  // of the nodes of the mesh [m]
  std::vector<FieldValues> fields;
  std::vector<Vec3> higher_order_positions = {};  // of HigherOrderNodes [m]
};

struct LineFrame {
  std::vector<Vec3> points;    // in the world, from end to end [m]; their number may vary
  std::vector<double> values;  // one for each of LineInfo::values
};

// The state of all objects at one time, as plain arrays.
struct Frame {
  std::int64_t index = 0;
  double time = 0;  // [s]
  std::int64_t step = 0;
  std::vector<BodyFrame> bodies;
  std::vector<Pose> poses;       // of the rigid bodies that move
  std::vector<LineFrame> lines;  // one for each of FrameLayout::lines
  std::vector<double> series;    // one value for each of FrameLayout::series
  Digest digest = {};
};

// Meaning of one scalar of every frame.
struct SeriesInfo {
  std::string name;  // `energy/elastic`, `muscle/volume_ratio`, `muscle/reaction/origin/z`, `probe/belly/x`
  std::string unit;
  std::string description;
};

// A rigid body, such as a bone or a floor.
struct RigidBodyInfo {
  std::string name;    // unique among the rigid bodies
  TriangleMesh shape;  // in the body's frame [m]; without triangles if there is nothing to draw
  Pose pose;           // at time 0
  bool moves = false;  // whether frames have its pose; otherwise it does not move
  // Whether the shape is a part of an unbounded plane, normal to the body's z axis, which points outward.
  bool unbounded = false;
};

// A line, such as the path of a muscle or a tendon.
struct LineInfo {
  std::string name;                // unique among the lines
  std::vector<SeriesInfo> values;  // such as `activation`, `length`, `tension`
};

// The nodes that the elements of a body have beside their corners, which are the nodes of its mesh.
struct HigherOrderNodes {
  std::vector<Vec3> positions;  // at rest [m]
  // Those of each element, in the mesh's order of elements and VTK's order of nodes, counted on from the mesh's nodes.
  std::vector<std::int32_t> of_elements;
  std::vector<std::vector<std::int32_t>> of_regions;  // those of each region of the body, ascending
};

// The contents of a simulation's frames besides bodies; constant.
struct FrameLayout {
  std::vector<RigidBodyInfo> rigid_bodies;
  std::vector<LineInfo> lines;
  std::vector<SeriesInfo> series;
  std::vector<HigherOrderNodes> higher_order = {};  // of each body; empty if no body has any
  std::vector<std::string> notes = {};              // remarks for the user on what is not a body
};

// See core/base/frame_digest.h.
Digest DigestOf(const Frame& frame);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SIM_FRAME_H_
