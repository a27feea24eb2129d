#include <bit>
#include <cstring>
#include <span>
#include <string>

#include "core/geometry/hexahedron.h"
#include "server/translate/translate.h"

namespace fascicle::server {
namespace {

// The wire format is little-endian and packed, like memory, so encoding is copying.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Tetrahedron) == 4 * sizeof(std::uint32_t) &&
              sizeof(Brick) == 8 * sizeof(std::uint32_t) && sizeof(Triangle) == 3 * sizeof(std::uint32_t) &&
              sizeof(Pose) == 7 * sizeof(double));

template <class T>
std::string Bytes(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

v1::FieldValues::Location LocationOf(FieldLocation location) {
  switch (location) {
    case FieldLocation::kTetrahedron:
      return v1::FieldValues::LOCATION_TETRAHEDRON;
    case FieldLocation::kBrick:
      return v1::FieldValues::LOCATION_BRICK;
    case FieldLocation::kNode:
      return v1::FieldValues::LOCATION_NODE;
  }
  return v1::FieldValues::LOCATION_UNSPECIFIED;
}

// Hexahedra in the order of bricks.
std::vector<Brick> BricksOf(const std::vector<Hexahedron>& hexahedra) {
  std::vector<Brick> bricks(hexahedra.size());
  for (std::size_t h = 0; h < hexahedra.size(); ++h) {
    for (std::size_t c = 0; c < 8; ++c) bricks[h][c] = hexahedra[h][static_cast<std::size_t>(kBrickOrder[c])];
  }
  return bricks;
}

void EncodeShape(const TetShape& shape, v1::BodyGeometry& geometry) {
  EncodeElements(shape, geometry);
  geometry.set_fibres(Bytes(shape.fibres));
}

void EncodeShape(const VoxelShape& shape, v1::BodyGeometry& geometry) { geometry.set_bricks(Bytes(shape.mesh.bricks)); }

// The filling of a surface and its fibres are not encoded.
void EncodeShape(const SurfaceShape& shape, v1::BodyGeometry& geometry) {
  geometry.set_triangles(Bytes(shape.mesh.triangles));
}

void EncodeSeries(const std::vector<SeriesInfo>& series, google::protobuf::RepeatedPtrField<v1::SeriesInfo>& encoded) {
  for (const SeriesInfo& info : series) {
    v1::SeriesInfo& one = *encoded.Add();
    one.set_name(info.name);
    one.set_unit(info.unit);
    one.set_description(info.description);
  }
}

void EncodeHigherOrder(const HigherOrderNodes& nodes, v1::BodyGeometry& geometry) {
  geometry.set_higher_order_positions(Bytes(nodes.positions));
  geometry.set_higher_order_nodes(Bytes(nodes.of_elements));
  for (std::size_t r = 0; r < nodes.of_regions.size(); ++r) {
    geometry.mutable_regions(static_cast<int>(r))->set_higher_order_nodes(Bytes(nodes.of_regions[r]));
  }
}

v1::Failure::ObjectKind KindOf(ObjectKind kind) {
  switch (kind) {
    case ObjectKind::kNone:
      return v1::Failure::OBJECT_KIND_UNSPECIFIED;
    case ObjectKind::kBody:
      return v1::Failure::OBJECT_KIND_BODY;
    case ObjectKind::kRigidBody:
      return v1::Failure::OBJECT_KIND_RIGID_BODY;
    case ObjectKind::kLine:
      return v1::Failure::OBJECT_KIND_LINE;
    case ObjectKind::kJoint:
      return v1::Failure::OBJECT_KIND_JOINT;
  }
  return v1::Failure::OBJECT_KIND_UNSPECIFIED;
}

v1::LogLine::Kind KindOf(LogLine::Kind kind) {
  switch (kind) {
    case LogLine::Kind::kStep:
      return v1::LogLine::KIND_STEP;
    case LogLine::Kind::kCut:
      return v1::LogLine::KIND_CUT;
    case LogLine::Kind::kFrame:
      return v1::LogLine::KIND_FRAME;
    case LogLine::Kind::kInput:
      return v1::LogLine::KIND_INPUT;
    case LogLine::Kind::kWarning:
      return v1::LogLine::KIND_WARNING;
    case LogLine::Kind::kFailure:
      return v1::LogLine::KIND_FAILURE;
  }
  return v1::LogLine::KIND_UNSPECIFIED;
}

}  // namespace

void EncodeElements(const TetShape& shape, v1::BodyGeometry& geometry) {
  if (shape.mesh.hexahedra.empty()) {
    geometry.set_tetrahedra(Bytes(shape.mesh.tetrahedra));
  } else {
    geometry.set_bricks(Bytes(BricksOf(shape.mesh.hexahedra)));
  }
}

v1::Geometry EncodeGeometry(const Scene& scene, const FrameLayout& layout) {
  v1::Geometry geometry;
  for (const Body& body : scene.bodies) {
    v1::BodyGeometry& encoded = *geometry.add_bodies();
    encoded.set_name(body.name);
    encoded.set_positions(Bytes(body.nodes()));
    std::visit([&encoded](const auto& shape) { EncodeShape(shape, encoded); }, body.shape);
    for (const std::string& note : body.notes) encoded.add_notes(note);
    for (const Region& region : body.regions) {
      v1::RegionGeometry& nodes = *encoded.add_regions();
      nodes.set_name(region.name);
      nodes.set_nodes(Bytes(region.nodes));
    }
  }
  for (std::size_t b = 0; b < layout.higher_order.size(); ++b) {
    EncodeHigherOrder(layout.higher_order[b], *geometry.mutable_bodies(static_cast<int>(b)));
  }
  for (const RigidBodyInfo& body : layout.rigid_bodies) {
    v1::RigidBodyGeometry& encoded = *geometry.add_rigid_bodies();
    encoded.set_name(body.name);
    encoded.set_positions(Bytes(body.shape.nodes));
    encoded.set_triangles(Bytes(body.shape.triangles));
    encoded.set_pose(Bytes(std::vector<Pose>{body.pose}));
    encoded.set_moves(body.moves);
    encoded.set_unbounded(body.unbounded);
  }
  for (const LineInfo& line : layout.lines) {
    v1::LineGeometry& encoded = *geometry.add_lines();
    encoded.set_name(line.name);
    EncodeSeries(line.values, *encoded.mutable_values());
  }
  EncodeSeries(layout.series, *geometry.mutable_series());
  for (const std::string& note : layout.notes) geometry.add_notes(note);
  return geometry;
}

v1::Frame EncodeFrame(const Frame& frame) {
  v1::Frame encoded;
  encoded.set_index(frame.index);
  encoded.set_time(frame.time);
  encoded.set_step(frame.step);
  for (const BodyFrame& body : frame.bodies) {
    v1::BodyFrame& target = *encoded.add_bodies();
    target.set_positions(Bytes(body.positions));
    target.set_higher_order_positions(Bytes(body.higher_order_positions));
    for (const FieldValues& field : body.fields) {
      v1::FieldValues& values = *target.add_fields();
      values.set_name(field.name);
      values.set_location(LocationOf(field.location));
      values.set_components(field.components);
      values.set_unit(field.unit);
      values.set_values(Bytes(field.values));
      values.set_all_values(Bytes(field.all_values));
    }
  }
  encoded.mutable_series()->Assign(frame.series.begin(), frame.series.end());
  encoded.set_poses(Bytes(frame.poses));
  for (const LineFrame& line : frame.lines) {
    v1::LineFrame& target = *encoded.add_lines();
    target.set_points(Bytes(line.points));
    target.mutable_values()->Assign(line.values.begin(), line.values.end());
  }
  encoded.set_digest(frame.digest.data(), frame.digest.size());
  return encoded;
}

v1::Warnings EncodeWarnings(const std::vector<Warning>& warnings) {
  v1::Warnings messages;
  for (const Warning& warning : warnings) {
    v1::Warning& message = *messages.add_warnings();
    message.set_reason(warning.reason);
    message.set_message(warning.message);
    message.set_advice(warning.advice);
    message.set_time(warning.time);
    message.set_body(warning.body);
    for (const std::int64_t element : warning.elements) message.add_element_ids(element);
  }
  return messages;
}

v1::LogLine EncodeLine(const LogLine& line) {
  v1::LogLine encoded;
  encoded.set_kind(KindOf(line.kind));
  encoded.set_step(line.step);
  encoded.set_time(line.time);
  encoded.set_steps(line.steps);
  encoded.set_time_step(line.time_step);
  encoded.set_iterations(line.iterations);
  encoded.set_cuts(line.cuts);
  if (line.residual >= 0) encoded.set_residual(line.residual);
  if (line.frame >= 0) encoded.set_frame(line.frame);
  encoded.set_text(line.text);
  encoded.set_sequence(line.sequence);
  return encoded;
}

v1::Failure EncodeFailure(const Failure& failure) {
  v1::Failure encoded;
  encoded.set_reason(failure.reason);
  encoded.set_message(failure.message);
  encoded.set_step(failure.step);
  encoded.set_time(failure.time);
  encoded.set_object_kind(KindOf(failure.object_kind));
  encoded.set_object(failure.object);
  if (failure.object_kind == ObjectKind::kBody) encoded.set_body(failure.object);
  encoded.mutable_element_ids()->Assign(failure.elements.begin(), failure.elements.end());
  encoded.set_advice(failure.advice);
  return encoded;
}

}  // namespace fascicle::server
