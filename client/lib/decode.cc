#include "client/lib/decode.h"

#include <bit>
#include <cstring>
#include <stdexcept>

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

static_assert(sizeof(Vec3) == 3 * sizeof(double));

template <class Cell>
void CheckNodes(const std::vector<Cell>& cells, std::size_t nodes, const std::string& what) {
  for (const Cell& cell : cells) {
    for (const std::uint32_t node : cell) {
      if (node >= nodes) throw std::runtime_error("the server sent " + what + " with an unknown node");
    }
  }
}

BodyShape DecodeBody(const v1::BodyGeometry& body) {
  BodyShape shape;
  shape.name = body.name();
  shape.positions = DecodeArray<Vec3>(body.positions(), "rest positions");
  shape.tetrahedra = DecodeArray<std::array<std::uint32_t, 4>>(body.tetrahedra(), "tetrahedra");
  shape.fibres = DecodeArray<Vec3>(body.fibres(), "fibres");
  shape.bricks = DecodeArray<std::array<std::uint32_t, 8>>(body.bricks(), "voxels");
  shape.triangles = DecodeArray<std::array<std::uint32_t, 3>>(body.triangles(), "triangles");
  CheckNodes(shape.triangles, shape.positions.size(), "a triangle");
  CheckNodes(shape.tetrahedra, shape.positions.size(), "a tetrahedron");
  CheckNodes(shape.bricks, shape.positions.size(), "a voxel");
  if (!shape.fibres.empty() && shape.fibres.size() != shape.tetrahedra.size()) {
    throw std::runtime_error("the server sent fibres that don't fit the tetrahedra");
  }
  for (const v1::RegionGeometry& region : body.regions()) {
    shape.regions.push_back({region.name(), DecodeArray<std::uint32_t>(region.nodes(), "a region")});
    for (const std::uint32_t node : shape.regions.back().nodes) {
      if (node >= shape.positions.size()) throw std::runtime_error("the server sent a region with an unknown node");
    }
  }
  return shape;
}

}  // namespace

std::vector<BodyShape> DecodeGeometry(const v1::Geometry& geometry) {
  std::vector<BodyShape> shapes;
  for (const v1::BodyGeometry& body : geometry.bodies()) shapes.push_back(DecodeBody(body));
  return shapes;
}

std::vector<Vec3> DecodePositions(const v1::BodyFrame& frame, std::size_t nodes) {
  std::vector<Vec3> positions = DecodeArray<Vec3>(frame.positions(), "positions");
  if (positions.size() != nodes) throw std::runtime_error("the server sent positions that don't fit the mesh");
  return positions;
}

std::vector<double> DecodeField(const v1::FieldValues& field, const BodyShape& shape) {
  std::vector<double> values = DecodeArray<double>(field.values(), "field " + field.name());
  const std::size_t tuples = field.location() == v1::FieldValues::LOCATION_NODE    ? shape.positions.size()
                             : field.location() == v1::FieldValues::LOCATION_BRICK ? shape.bricks.size()
                                                                                   : shape.tetrahedra.size();
  if (field.components() < 1 || values.size() != tuples * static_cast<std::size_t>(field.components())) {
    throw std::runtime_error("the server sent field " + field.name() + " that doesn't fit the mesh");
  }
  return values;
}

void CheckFits(const v1::Frame& frame, const v1::Geometry& geometry) {
  if (frame.bodies_size() != geometry.bodies_size() || frame.series_size() != geometry.series_size()) {
    throw std::runtime_error("the server sent a frame that doesn't fit its geometry");
  }
}

}  // namespace fascicle::client
