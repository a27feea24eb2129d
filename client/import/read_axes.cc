// <fiber> and <mat_axis> of materials [FEBio Feature Manual, vec3dvaluator and mat3dvaluator].
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string_view>

#include "client/import/sections.h"
#include "core/geometry/text_scanner.h"

namespace fascicle::client {
namespace {

// theta and phi in degrees.
struct Angles {
  double theta = 0, phi = 90;
  double ToRadians(double degrees) const { return degrees * std::numbers::pi / 180; }
  Vec3 Radial() const {
    const double t = ToRadians(theta), p = ToRadians(phi);
    return {std::cos(t) * std::sin(p), std::sin(t) * std::sin(p), std::cos(p)};
  }
  Mat3 Frame() const {
    const double t = ToRadians(theta), p = ToRadians(phi);
    Mat3 frame;
    frame << Radial(), Vec3(-std::sin(t), std::cos(t), 0),
        Vec3(-std::cos(t) * std::cos(p), -std::sin(t) * std::cos(p), std::sin(p));
    return frame;
  }
};

Angles ReadAngles(pugi::xml_node node, XmlSource& source) {
  source.Take(node);
  Angles angles;
  if (const pugi::xml_node theta = node.child("theta")) angles.theta = source.Number(theta);
  if (const pugi::xml_node phi = node.child("phi")) angles.phi = source.Number(phi);
  return angles;
}

// Local node numbers counted from 0; 0, 0 (, 0) means the first ones.
template <std::size_t N>
std::optional<std::array<int, N>> ReadLocal(pugi::xml_node node, XmlSource& source, std::array<int, N> standard) {
  const auto numbers = source.Integers(node, N);
  if (!numbers) return std::nullopt;
  std::array<int, N> local;
  bool all_zero = true;
  for (std::size_t n = 0; n < N; ++n) {
    const std::int64_t number = (*numbers)[n];
    all_zero = all_zero && number == 0;
    local[n] = number >= 1 && number <= 10 ? static_cast<int>(number - 1) : -1;
  }
  if (all_zero) return standard;
  for (std::size_t n = 0; n < N; ++n) {
    for (std::size_t m = 0; m < n; ++m) {
      if (local[n] == local[m]) local[n] = -1;
    }
    if (local[n] >= 0) continue;
    source.Fail(node, "does not name " + std::to_string(N) + " nodes of an element", "count its nodes from 1");
    return std::nullopt;
  }
  return local;
}

// Version 4 may write a value as an element of the type's name.
pugi::xml_node Inner(pugi::xml_node node, XmlSource& source) {
  const pugi::xml_node inner = node.child(node.attribute("type").value());
  if (inner) source.Take(node);
  return inner ? inner : node;
}

std::optional<Vec3> ReadDirection(pugi::xml_node node, XmlSource& source) {
  const auto vector = source.Vector(node);
  if (!vector) return std::nullopt;
  const Vec3 unit = vector->stableNormalized();
  if (unit.norm() > 0.5) return unit;
  source.Fail(node, "is zero", "give a direction");
  return std::nullopt;
}

// `cylindrical` or `spherical`. A spherical one may be its centre alone.
std::optional<Round> ReadRound(pugi::xml_node node, bool is_cylindrical, XmlSource& source) {
  source.Take(node);
  Round round;
  if (is_cylindrical) round.axis = Vec3::UnitZ();
  if (!is_cylindrical && !node.child("center") && !node.child("vector") && !source.Text(node).empty()) {
    const auto centre = source.Vector(node);
    if (!centre) return std::nullopt;
    round.centre = *centre;
    return round;
  }
  const pugi::xml_node centre = node.child("center"), axis = node.child("axis"), vector = node.child("vector");
  if (centre) {
    const auto read = source.Vector(centre);
    if (!read) return std::nullopt;
    round.centre = *read;
  }
  if (axis && is_cylindrical) {
    round.axis = ReadDirection(axis, source);
    if (!round.axis) return std::nullopt;
  }
  if (vector) {
    const auto read = ReadDirection(vector, source);
    if (!read) return std::nullopt;
    round.vector = *read;
  }
  return round;
}

}  // namespace

std::optional<Mat3> ReadFrame(pugi::xml_node node, XmlSource& source) {
  source.Take(node);
  Vec3 a = Vec3::UnitX(), d = Vec3::UnitY();
  for (const auto& [name, vector] : {std::pair("a", &a), std::pair("d", &d)}) {
    const pugi::xml_node child = node.child(name);
    if (!child) continue;
    const auto read = source.Vector(child);
    if (!read) return std::nullopt;
    *vector = *read;
  }
  // In two steps, so that no length underflows or overflows.
  a = a.stableNormalized();
  d = d.stableNormalized();
  const Vec3 across = a.cross(d);
  if (!(across.norm() > 1e-6)) {
    source.Fail(node, "its vectors a and d do not span a plane", "give two directions that differ");
    return std::nullopt;
  }
  Mat3 frame;
  frame.col(0) = a;
  frame.col(2) = across.normalized();
  frame.col(1) = frame.col(2).cross(a);
  return frame;
}

std::optional<Axes> ReadAxes(pugi::xml_node node, XmlSource& source) {
  Axes axes;
  axes.node = node;
  const std::string_view type = node.attribute("type").as_string("vector");
  if (type == "vector") {
    const auto frame = ReadFrame(node, source);
    if (!frame) return std::nullopt;
    axes.given = *frame;
  } else if (type == "angles") {
    axes.given = ReadAngles(node, source).Frame();
  } else if (type == "local") {
    axes.local = ReadLocal<3>(Inner(node, source), source, {0, 1, 3});
    if (!axes.local) return std::nullopt;
  } else if (type == "cylindrical" || type == "spherical") {
    axes.round = ReadRound(node, type == "cylindrical", source);
    if (!axes.round) return std::nullopt;
  } else {
    source.Fail(node, "material axes of type " + Quoted(type) + " are not supported",
                "give them by vector, angles, local, cylindrical, spherical, or as element data");
    return std::nullopt;
  }
  return axes;
}

std::optional<FibreSource> ReadFibre(pugi::xml_node node, XmlSource& source) {
  FibreSource fibre;
  fibre.node = node;
  const std::string_view type = node.attribute("type").as_string("vector");
  if (type == "vector" || type == "const") {
    // Version 4 also writes the vector as an element.
    source.Take(node);
    const pugi::xml_node inner = node.child("vector");
    const auto vector = source.Vector(inner ? inner : node);
    if (!vector) return std::nullopt;
    fibre.vector = vector->stableNormalized();
  } else if (type == "angles") {
    fibre.vector = ReadAngles(node, source).Radial();
  } else if (type == "local") {
    const auto local = ReadLocal<2>(Inner(node, source), source, {0, 1});
    if (!local) return std::nullopt;
    fibre.kind = FibreSource::Kind::kLocal;
    fibre.local = *local;
  } else if (type == "map") {
    fibre.kind = FibreSource::Kind::kMap;
    fibre.map = source.Text(Inner(node, source));
  } else if (type == "cylindrical" || type == "spherical") {
    const auto round = ReadRound(node, type == "cylindrical", source);
    if (!round) return std::nullopt;
    fibre.kind = FibreSource::Kind::kRound;
    fibre.round = *round;
  } else if (type == "user") {
    source.Take(node);  // version 3: the element data define it
  } else {
    source.Fail(node, "fibres of type " + Quoted(type) + " are not supported",
                "give them by vector, angles, local, cylindrical, spherical, map, or as element data");
    return std::nullopt;
  }
  if (fibre.kind == FibreSource::Kind::kVector && !(fibre.vector.norm() > 0.5)) {
    source.Fail(node, "the fibre's direction is zero", "give a direction");
    return std::nullopt;
  }
  return fibre;
}

}  // namespace fascicle::client
