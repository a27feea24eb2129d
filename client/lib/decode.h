#ifndef FASCICLE_CLIENT_LIB_DECODE_H_
#define FASCICLE_CLIENT_LIB_DECODE_H_

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/pose.h"
#include "core/base/types.h"
#include "fascicle/v1/frame.pb.h"

namespace fascicle::client {

// Decodes the bytes of frames and geometry to arrays. All functions throw std::runtime_error, with a message for users,
// if sizes are wrong, indices out of range or values missing.

// Rest geometry of one body.
struct BodyShape {
  std::string name;
  // Of all nodes: those of the mesh, then the mid-edge nodes of quadratic tetrahedra if the job has them [m].
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 4>> tetrahedra;  // node indices, all in range
  // The mid-edge nodes of each tetrahedron in VTK's order, on its edges 01 12 02 03 13 23; empty if edges are straight.
  std::vector<std::array<std::uint32_t, 6>> mid_edges;
  std::vector<std::array<std::uint32_t, 8>> bricks;     // in place of tetrahedra: voxels or hexahedra
  std::vector<std::array<std::uint32_t, 3>> triangles;  // in place of tetrahedra: a closed surface
  std::vector<Vec3> fibres;                             // unit, one for each element, or empty
  struct Region {
    std::string name;
    std::vector<std::uint32_t> nodes;  // all in range; mid-edge nodes, too
  };
  std::vector<Region> regions;

  std::size_t elements() const { return tetrahedra.size() + bricks.size() + triangles.size(); }
  bool quadratic() const { return !mid_edges.empty(); }
  // The ten nodes of a tetrahedron that has mid-edge nodes.
  std::array<std::uint32_t, 10> TenNodes(std::size_t tetrahedron) const;
};

std::vector<BodyShape> DecodeGeometry(const v1::Geometry& geometry);

// Positions [m] of a body with `nodes` nodes in BodyShape::positions.
std::vector<Vec3> DecodePositions(const v1::BodyFrame& frame, std::size_t nodes);

// Values of a field, component fastest: `components` for each node or element of `shape`.
std::vector<double> DecodeField(const v1::FieldValues& field, const BodyShape& shape);

// A rigid body: its shape, and its pose at time 0.
struct RigidShape {
  std::string name;
  std::vector<Vec3> positions;                          // in the body's frame [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  // node indices, all in range
  Pose pose;                                            // finite, with a unit quaternion
  bool moves = false;                                   // whether frames have its pose
  bool unbounded = false;                               // a part of an unbounded plane normal to the z axis
};

std::vector<RigidShape> DecodeRigidBodies(const v1::Geometry& geometry);

// The poses of a frame with `count` moving rigid bodies: finite, with unit quaternions.
std::vector<Pose> DecodePoses(const v1::Frame& frame, std::size_t count);
// The pose of each rigid body in a frame, including those that do not move.
std::vector<Pose> PosesOf(const v1::Frame& frame, const std::vector<RigidShape>& bodies);
// The vertices of a rigid body in world coordinates [m].
std::vector<Vec3> PositionsAt(const RigidShape& body, const Pose& pose);

// A line and the meaning of its values.
struct LineInfo {
  std::string name;
  std::vector<v1::SeriesInfo> values;
};

std::vector<LineInfo> DecodeLineInfos(const v1::Geometry& geometry);

// A line in a frame.
struct LinePath {
  std::vector<Vec3> points;    // finite; their number may vary [m]
  std::vector<double> values;  // one for each of LineInfo::values
};

std::vector<LinePath> DecodeLines(const v1::Frame& frame, const std::vector<LineInfo>& lines);

// Throws unless `frame` has as many bodies, poses, lines and series as `geometry`.
void CheckFits(const v1::Frame& frame, const v1::Geometry& geometry);

// Throws unless the frame's digest is that of its numbers, so that they arrived as the simulation computed them.
void CheckDigest(const v1::Frame& frame);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_DECODE_H_
