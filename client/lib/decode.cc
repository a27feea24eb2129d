#include "client/lib/decode.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "proto/frames/frame_digest.h"
#include "proto/frames/frame_fits.h"

namespace fascicle::client {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are little-endian; swap bytes here");

template <class T>
std::vector<T> DecodeArray(const std::string& bytes, const std::string& what) {
  if (bytes.size() % sizeof(T) != 0) throw std::runtime_error("the server sent " + what + " of a wrong size");
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
  return values;
}

static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Pose) == 7 * sizeof(double));

template <class Cell>
void CheckNodes(const std::vector<Cell>& cells, std::size_t nodes, const std::string& what) {
  for (const Cell& cell : cells) {
    for (const std::uint32_t node : cell) {
      if (node >= nodes) throw std::runtime_error("the server sent " + what + " with an unknown node");
    }
  }
}

// Appends the mid-edge nodes of tetrahedra. Higher-order nodes of other elements, which servers may send some day, are
// left out.
void DecodeHigherOrder(const v1::BodyGeometry& body, BodyShape& shape) {
  constexpr std::size_t kSize = 6 * sizeof(std::uint32_t);
  if (shape.tetrahedra.empty() || body.higher_order_nodes().size() != kSize * shape.tetrahedra.size()) return;
  shape.mid_edges = DecodeArray<std::array<std::uint32_t, 6>>(body.higher_order_nodes(), "mid-edge nodes");
  const std::vector<Vec3> middles = DecodeArray<Vec3>(body.higher_order_positions(), "mid-edge nodes");
  shape.positions.insert(shape.positions.end(), middles.begin(), middles.end());
  CheckNodes(shape.mid_edges, shape.positions.size(), "a tetrahedron");
}

BodyShape DecodeBody(const v1::BodyGeometry& body) {
  BodyShape shape;
  shape.name = body.name();
  shape.positions = DecodeArray<Vec3>(body.positions(), "rest positions");
  shape.tetrahedra = DecodeArray<std::array<std::uint32_t, 4>>(body.tetrahedra(), "tetrahedra");
  shape.fibres = DecodeArray<Vec3>(body.fibres(), "fibres");
  shape.bricks = DecodeArray<std::array<std::uint32_t, 8>>(body.bricks(), "voxels or hexahedra");
  shape.triangles = DecodeArray<std::array<std::uint32_t, 3>>(body.triangles(), "triangles");
  CheckNodes(shape.triangles, shape.positions.size(), "a triangle");
  CheckNodes(shape.tetrahedra, shape.positions.size(), "a tetrahedron");
  CheckNodes(shape.bricks, shape.positions.size(), "a voxel or hexahedron");
  DecodeHigherOrder(body, shape);
  if (!shape.fibres.empty() && shape.fibres.size() != shape.elements()) {
    throw std::runtime_error("the server sent fibres that don't fit the elements");
  }
  for (const v1::RegionGeometry& region : body.regions()) {
    shape.regions.push_back({region.name(), DecodeArray<std::uint32_t>(region.nodes(), "a region")});
    if (shape.quadratic()) {
      const auto more = DecodeArray<std::uint32_t>(region.higher_order_nodes(), "a region");
      std::vector<std::uint32_t>& nodes = shape.regions.back().nodes;
      nodes.insert(nodes.end(), more.begin(), more.end());
    }
    for (const std::uint32_t node : shape.regions.back().nodes) {
      if (node >= shape.positions.size()) throw std::runtime_error("the server sent a region with an unknown node");
    }
  }
  return shape;
}

void CheckPose(const Pose& pose) {
  double square = 0;
  for (const double q : pose.quaternion) square += q * q;
  if (!pose.position.allFinite() || !(std::abs(square - 1) < 1e-6)) {
    throw std::runtime_error("the server sent an invalid pose: it needs a finite position and a unit quaternion");
  }
}

RigidShape DecodeRigidBody(const v1::RigidBodyGeometry& body) {
  RigidShape shape;
  shape.name = body.name();
  shape.positions = DecodeArray<Vec3>(body.positions(), "the corners of a rigid body");
  shape.triangles = DecodeArray<std::array<std::uint32_t, 3>>(body.triangles(), "the triangles of a rigid body");
  CheckNodes(shape.triangles, shape.positions.size(), "a triangle of a rigid body");
  const std::vector<Pose> pose = DecodeArray<Pose>(body.pose(), "the pose of a rigid body");
  if (pose.size() != 1) throw std::runtime_error("the server sent a rigid body without its pose");
  CheckPose(pose[0]);
  shape.pose = pose[0];
  shape.moves = body.moves();
  shape.unbounded = body.unbounded();
  return shape;
}

}  // namespace

std::array<std::uint32_t, 10> BodyShape::TenNodes(std::size_t tetrahedron) const {
  std::array<std::uint32_t, 10> nodes;
  std::copy(tetrahedra[tetrahedron].begin(), tetrahedra[tetrahedron].end(), nodes.begin());
  std::copy(mid_edges[tetrahedron].begin(), mid_edges[tetrahedron].end(), nodes.begin() + 4);
  return nodes;
}

std::vector<BodyShape> DecodeGeometry(const v1::Geometry& geometry) {
  std::vector<BodyShape> shapes;
  for (const v1::BodyGeometry& body : geometry.bodies()) shapes.push_back(DecodeBody(body));
  return shapes;
}

std::vector<Vec3> DecodePositions(const v1::BodyFrame& frame, std::size_t nodes) {
  std::vector<Vec3> positions = DecodeArray<Vec3>(frame.positions(), "positions");
  if (positions.size() < nodes) {
    const std::vector<Vec3> more = DecodeArray<Vec3>(frame.higher_order_positions(), "positions of mid-edge nodes");
    positions.insert(positions.end(), more.begin(), more.end());
  }
  if (positions.size() != nodes) throw std::runtime_error("the server sent positions that don't fit the mesh");
  return positions;
}

std::vector<double> DecodeField(const v1::FieldValues& field, const BodyShape& shape) {
  const bool has_all = field.location() == v1::FieldValues::LOCATION_NODE && shape.quadratic();
  std::vector<double> values =
      DecodeArray<double>(has_all ? field.all_values() : field.values(), "field " + field.name());
  const std::size_t tuples = field.location() == v1::FieldValues::LOCATION_NODE    ? shape.positions.size()
                             : field.location() == v1::FieldValues::LOCATION_BRICK ? shape.bricks.size()
                                                                                   : shape.tetrahedra.size();
  if (field.components() < 1 || values.size() != tuples * static_cast<std::size_t>(field.components())) {
    throw std::runtime_error("the server sent field " + field.name() + " that doesn't fit the mesh");
  }
  return values;
}

std::vector<RigidShape> DecodeRigidBodies(const v1::Geometry& geometry) {
  std::vector<RigidShape> shapes;
  for (const v1::RigidBodyGeometry& body : geometry.rigid_bodies()) shapes.push_back(DecodeRigidBody(body));
  return shapes;
}

std::vector<Pose> DecodePoses(const v1::Frame& frame, std::size_t count) {
  std::vector<Pose> poses = DecodeArray<Pose>(frame.poses(), "poses");
  if (poses.size() != count) throw std::runtime_error("the server sent poses that don't fit the rigid bodies");
  for (const Pose& pose : poses) CheckPose(pose);
  return poses;
}

std::vector<Pose> PosesOf(const v1::Frame& frame, const std::vector<RigidShape>& bodies) {
  const auto count = std::count_if(bodies.begin(), bodies.end(), [](const RigidShape& body) { return body.moves; });
  const std::vector<Pose> moved = DecodePoses(frame, static_cast<std::size_t>(count));
  auto next = moved.begin();
  std::vector<Pose> poses;
  for (const RigidShape& body : bodies) poses.push_back(body.moves ? *next++ : body.pose);
  return poses;
}

std::vector<Vec3> PositionsAt(const RigidShape& body, const Pose& pose) {
  const Mat3 rotation = RotationOf(pose);
  std::vector<Vec3> positions;
  positions.reserve(body.positions.size());
  for (const Vec3& X : body.positions) positions.push_back(pose.position + rotation * X);
  return positions;
}

std::vector<LineInfo> DecodeLineInfos(const v1::Geometry& geometry) {
  std::vector<LineInfo> lines;
  for (const v1::LineGeometry& line : geometry.lines()) {
    lines.push_back({line.name(), {line.values().begin(), line.values().end()}});
  }
  return lines;
}

std::vector<LinePath> DecodeLines(const v1::Frame& frame, const std::vector<LineInfo>& lines) {
  if (static_cast<std::size_t>(frame.lines_size()) != lines.size()) {
    throw std::runtime_error("the server sent a wrong number of lines");
  }
  std::vector<LinePath> paths;
  for (const v1::LineFrame& line : frame.lines()) {
    const LineInfo& info = lines[paths.size()];
    LinePath path{DecodeArray<Vec3>(line.points(), "the points of a line"),
                  {line.values().begin(), line.values().end()}};
    if (path.values.size() != info.values.size()) {
      throw std::runtime_error("the server sent the line " + info.name + " with a wrong number of values");
    }
    for (const Vec3& x : path.points) {
      if (!x.allFinite())
        throw std::runtime_error("the server sent the line " + info.name + " with a point that is not finite");
    }
    paths.push_back(std::move(path));
  }
  return paths;
}

void CheckFits(const v1::Frame& frame, const v1::Geometry& geometry) {
  if (!FrameFits(frame, geometry)) {
    throw std::runtime_error("the server sent a frame that doesn't fit its geometry");
  }
}

void CheckDigest(const v1::Frame& frame) {
  if (frame.digest() != DigestOfNumbers(frame)) {
    throw std::runtime_error("frame " + std::to_string(frame.index()) +
                             " is damaged: its digest is not that of its numbers");
  }
}

}  // namespace fascicle::client
