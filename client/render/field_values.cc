#include "client/render/field_values.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "client/lib/tetrahedra.h"
#include "core/base/component_names.h"
#include "core/geometry/tet_mesh.h"

namespace fascicle::client {
namespace {

// The edges of a brick at its middle, with the volume of a parallelepiped.
Mat3 Edges(const std::vector<Vec3>& x, const std::array<std::uint32_t, 8>& brick) {
  Mat3 edges = Mat3::Zero();
  for (std::size_t c = 0; c < 8; ++c) {
    for (int d = 0; d < 3; ++d) edges.col(d) += ((c >> d & 1) != 0 ? 0.25 : -0.25) * x[brick[c]];
  }
  return edges;
}

// Calls visit(nodes, edges at its middle with nodes at given positions, index) for every element.
template <class Visit>
void ForElements(const BodyShape& shape, const Visit& visit) {
  for (std::size_t e = 0; e < shape.tetrahedra.size(); ++e) {
    const auto edges = [&, e](const std::vector<Vec3>& x) { return EdgesAt(shape, e, x, kCentroid); };
    if (shape.quadratic()) {
      visit(shape.TenNodes(e), edges, e);
    } else {
      visit(shape.tetrahedra[e], edges, e);
    }
  }
  for (std::size_t e = 0; e < shape.bricks.size(); ++e) {
    visit(
        shape.bricks[e], [&, e](const std::vector<Vec3>& x) { return Edges(x, shape.bricks[e]); }, e);
  }
}

// Averages the values of the elements around each node, weighted by rest volume.
std::vector<double> AverageAtNodes(const BodyShape& shape, const std::vector<double>& values) {
  std::vector<double> sums(shape.positions.size(), 0.0), weights(shape.positions.size(), 0.0);
  ForElements(shape, [&](const auto& nodes, const auto& edges, std::size_t e) {
    const double volume = std::abs(edges(shape.positions).determinant());
    for (const std::uint32_t node : nodes) {
      sums[node] += volume * values[e];
      weights[node] += volume;
    }
  });
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = weights[i] > 0 ? sums[i] / weights[i] : 0.0;
  return sums;
}

struct Tuples {
  std::vector<double> values;
  std::size_t components = 1;
  bool at_nodes = true;
  std::string unit;
};

// Forces on the nodes of quadratic elements alternate between corners and mid-edge nodes even where stresses are
// uniform. For display, those on mid-edge nodes are halved between the ends of the edge, and interpolated there.
Tuples ForcesOnCorners(const BodyShape& shape, const v1::FieldValues& field) {
  BodyShape corners = shape;
  corners.mid_edges.clear();
  corners.positions.resize(field.values().size() / sizeof(Vec3));
  Tuples tuples{DecodeField(field, corners), 3, true, field.unit()};
  tuples.values.resize(3 * shape.positions.size());
  for (std::size_t t = 0; t < shape.tetrahedra.size(); ++t) {
    for (std::size_t k = 0; k < kTetEdges.size(); ++k) {
      const std::size_t i = shape.tetrahedra[t][static_cast<std::size_t>(kTetEdges[k][0])],
                        j = shape.tetrahedra[t][static_cast<std::size_t>(kTetEdges[k][1])];
      for (std::size_t c = 0; c < 3; ++c) {
        tuples.values[3 * shape.mid_edges[t][k] + c] = 0.5 * (tuples.values[3 * i + c] + tuples.values[3 * j + c]);
      }
    }
  }
  return tuples;
}

Tuples FindField(const BodyShape& shape, const v1::BodyFrame& frame, const std::string& name) {
  if (name == "displacement") {
    Tuples tuples{{}, 3, true, "m"};
    const std::vector<Vec3> positions = DecodePositions(frame, shape.positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Vec3 u = positions[i] - shape.positions[i];
      tuples.values.insert(tuples.values.end(), u.data(), u.data() + 3);
    }
    return tuples;
  }
  for (const v1::FieldValues& field : frame.fields()) {
    if (field.name() == name) {
      if (field.unit() == "N" && shape.quadratic()) return ForcesOnCorners(shape, field);
      return {DecodeField(field, shape), static_cast<std::size_t>(field.components()),
              field.location() == v1::FieldValues::LOCATION_NODE, field.unit()};
    }
  }
  throw std::runtime_error("there is no field `" + name + "` in the frame; existing fields: " + FieldNames(frame) +
                           " (see the scene's output.fields)");
}

bool IsVector(const std::vector<std::string>& names) { return names.size() == 3 && names.front() == "x"; }

// One value per tuple: a component or, for vectors, the magnitude.
std::vector<double> Reduce(const Tuples& tuples, const std::string& field, const std::string& component) {
  const std::size_t n = tuples.components;
  std::size_t chosen = 0;
  const std::vector<std::string> names = ComponentNames(field, n);
  if (!component.empty() || (n > 1 && !IsVector(names))) {
    while (chosen < names.size() && names[chosen] != component) ++chosen;
    if (chosen == names.size()) {
      std::string hint;
      for (const std::string& name : names) hint += " " + field + "/" + name;
      throw std::runtime_error(n == 1 ? "field `" + field + "` has no components"
                                      : "give one of the components:" + hint);
    }
  }
  std::vector<double> values(tuples.values.size() / n);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double* tuple = &tuples.values[i * n];
    values[i] = n > 1 && component.empty() ? Eigen::Map<const Vec3>(tuple).norm() : tuple[chosen];
  }
  return values;
}

}  // namespace

bool HasField(const v1::BodyFrame& frame, const std::string& field) {
  const std::string name = field.substr(0, field.find('/'));
  return name == "displacement" || std::any_of(frame.fields().begin(), frame.fields().end(),
                                               [&](const v1::FieldValues& values) { return values.name() == name; });
}

std::string FieldNames(const v1::BodyFrame& frame) {
  std::string names = "displacement";
  for (const v1::FieldValues& field : frame.fields()) names += ", " + field.name();
  return names;
}

NodeValues ValuesAtNodes(const BodyShape& shape, const v1::BodyFrame& frame, const std::string& field) {
  const std::size_t slash = field.find('/');
  const std::string name = field.substr(0, slash);
  const std::string component = slash == std::string::npos ? "" : field.substr(slash + 1);
  const Tuples tuples = FindField(shape, frame, name);
  NodeValues result{Reduce(tuples, name, component), component.empty() ? name : name + " " + component, tuples.unit};
  if (!tuples.at_nodes) result.values = AverageAtNodes(shape, result.values);
  return result;
}

std::vector<Vec3> FibresAtNodes(const BodyShape& shape, const std::vector<Vec3>& positions) {
  std::vector<Vec3> sums(shape.positions.size(), Vec3::Zero());
  if (shape.fibres.empty()) return sums;
  ForElements(shape, [&](const auto& nodes, const auto& edges, std::size_t e) {
    const Mat3 rest = edges(shape.positions);
    const Vec3 deformed = edges(positions) * rest.inverse() * shape.fibres[e];
    const double weight = std::abs(rest.determinant()) / deformed.norm();
    if (!std::isfinite(weight)) return;
    for (const std::uint32_t n : nodes) sums[n] += (sums[n].dot(deformed) < 0 ? -weight : weight) * deformed;
  });
  for (Vec3& sum : sums) {
    if (sum.norm() > 0) sum.normalize();
  }
  return sums;
}

}  // namespace fascicle::client
