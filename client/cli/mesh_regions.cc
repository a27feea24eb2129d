#include "client/cli/mesh_regions.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "client/cli/input_file.h"
#include "core/base/stop.h"
#include "core/geometry/triangle_tree.h"

namespace fascicle::client {
namespace {

constexpr const char* kForms =
    "NAME=end:X,Y,Z:LENGTH, NAME=side:X,Y,Z, NAME=side:X,Y,Z:DEGREES or NAME=near:SURFACE:DISTANCE";
constexpr double kDefaultAngle = 45;  // [degree]

bool ParseNumber(std::string_view text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

// Whether the text is a valid name in a scene.
bool IsName(const std::string& name) {
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  });
}

// Parses X,Y,Z, not all zero.
std::optional<Vec3> ParseDirection(std::string_view text) {
  Vec3 direction;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t comma = text.find(',');
    if ((comma == std::string_view::npos) != (axis == 2)) return std::nullopt;
    if (!ParseNumber(text.substr(0, comma), direction[axis])) return std::nullopt;
    text = comma == std::string_view::npos ? std::string_view() : text.substr(comma + 1);
  }
  if (direction.isZero(0)) return std::nullopt;
  return direction;
}

std::optional<SideSelector> ParseSide(std::string_view text) {
  double angle = kDefaultAngle;
  const std::size_t colon = text.find(':');
  if (colon != std::string_view::npos && !ParseNumber(text.substr(colon + 1), angle)) return std::nullopt;
  const auto direction = ParseDirection(text.substr(0, colon));
  if (!direction || angle < 0 || angle > 180) return std::nullopt;
  return SideSelector{*direction, angle * std::numbers::pi / 180};
}

std::optional<RegionRequest::End> ParseEnd(std::string_view text) {
  const std::size_t colon = text.find(':');
  double length = 0;
  if (colon == std::string_view::npos || !ParseNumber(text.substr(colon + 1), length)) return std::nullopt;
  const auto direction = ParseDirection(text.substr(0, colon));
  if (!direction || length <= 0) return std::nullopt;
  return RegionRequest::End{*direction, length};
}

std::optional<RegionRequest::Near> ParseNear(std::string_view text) {
  RegionRequest::Near near;
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return std::nullopt;
  near.file = text.substr(0, colon);
  if (!ParseNumber(text.substr(colon + 1), near.distance) || near.distance < 0) return std::nullopt;
  return near;
}

void ReadOther(RegionRequest::Near& near, const std::string& path, const std::stop_token& stop, Problems& problems) {
  Problems in_file;
  std::optional<TriangleMesh> surface;
  if (const auto bytes = ReadInputFile(near.file, in_file)) surface = ReadSurface(near.file, *bytes, in_file, stop);
  if (surface) near.surface = std::move(*surface);
  for (const Problem& problem : in_file.kept()) problems.Add(path, near.file + ": " + problem.message, problem.hint);
}

// Selects everything within `length` of the farthest node along a direction.
PlaneSelector BelowFurthest(const TetMesh& mesh, const RegionRequest::End& end) {
  const Vec3 direction = end.direction.normalized();
  double furthest = -std::numeric_limits<double>::infinity();
  for (const Vec3& x : mesh.nodes) furthest = std::max(furthest, x.dot(direction));
  return {(furthest - end.length) * direction, direction};
}

// A hint for an empty region.
std::string EmptyHint(const RegionRequest& request, const TetMesh& mesh, const std::vector<Triangle>& surface) {
  if (std::holds_alternative<RegionRequest::End>(request.selector)) return "try a larger length";
  const auto* near = std::get_if<RegionRequest::Near>(&request.selector);
  if (near == nullptr) return "try a larger angle";
  const TriangleTree tree(near->surface);
  double nearest = std::numeric_limits<double>::infinity();
  for (const Triangle& triangle : surface) {
    double furthest = 0;
    for (const std::int32_t n : triangle) furthest = std::max(furthest, tree.Distance(mesh.nodes[n]));
    nearest = std::min(nearest, furthest);
  }
  char text[160];
  std::snprintf(text, sizeof text, "the nearest triangle is %.4g away: are both surfaces in the same unit and frame?",
                nearest);
  return text;
}

}  // namespace

std::vector<RegionRequest> ReadRegionRequests(const std::vector<std::string>& options, const std::stop_token& stop,
                                              Problems& problems) {
  std::vector<RegionRequest> requests;
  std::set<std::string> names;
  for (const std::string& option : options) {
    const std::size_t equals = option.find('=');
    const std::string name = option.substr(0, equals);
    const std::string path = "--region " + name;
    if (equals == std::string::npos) {
      problems.Add(path, "has no =", std::string("expects ") + kForms);
      continue;
    }
    if (!IsName(name)) problems.Add(path, "is not a name", "letters, digits, _, - and ., at most 64");
    if (!names.insert(name).second) problems.Add(path, "occurs twice", "give each region a unique name");
    const std::string_view value = std::string_view(option).substr(equals + 1);
    RegionRequest request{name, SideSelector{}};
    if (value.starts_with("side:")) {
      if (const auto side = ParseSide(value.substr(5))) {
        request.selector = *side;
      } else {
        problems.Add(path, "expects a direction, and optionally an angle of 0 to 180 degrees", "such as side:0,0,1:30");
      }
    } else if (value.starts_with("end:")) {
      if (const auto end = ParseEnd(value.substr(4))) {
        request.selector = *end;
      } else {
        problems.Add(path, "expects a direction and a length above 0", "such as end:0,0,1:15");
      }
    } else if (value.starts_with("near:")) {
      if (auto near = ParseNear(value.substr(5))) {
        ReadOther(*near, path, stop, problems);
        request.selector = std::move(*near);
      } else {
        problems.Add(path, "expects a surface and a distance of 0 or more", "such as near:fibula.stl:3");
      }
    } else {
      problems.Add(path, "has an unknown kind", std::string("expects ") + kForms);
    }
    requests.push_back(std::move(request));
  }
  return requests;
}

void CheckEnds(const Region& origin, const Region& insertion, Problems& problems) {
  std::vector<std::int32_t> common;
  std::set_intersection(origin.nodes.begin(), origin.nodes.end(), insertion.nodes.begin(), insertion.nodes.end(),
                        std::back_inserter(common));
  if (common.empty()) return;
  problems.Add("--region " + insertion.name,
               "has " + std::to_string(common.size()) + " nodes in common with " + origin.name,
               "the ends of a muscle must be separate: use smaller regions, or end:X,Y,Z:LENGTH");
}

std::vector<Region> MarkRegions(const std::vector<RegionRequest>& requests, const std::stop_token& stop, TetMesh& mesh,
                                Problems& problems) {
  const std::vector<Triangle> surface = BoundaryTriangles(mesh, stop);
  std::vector<Region> regions;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    ThrowIfStopped(stop);
    const RegionRequest& request = requests[i];
    if (const auto* side = std::get_if<SideSelector>(&request.selector)) {
      regions.push_back(SelectRegion(mesh, surface, request.name, *side));
    } else if (const auto* end = std::get_if<RegionRequest::End>(&request.selector)) {
      regions.push_back(SelectRegion(mesh, surface, request.name, BelowFurthest(mesh, *end)));
    } else {
      const auto& near = std::get<RegionRequest::Near>(request.selector);
      regions.push_back(SelectNear(mesh, surface, request.name, TriangleTree(near.surface), near.distance, stop));
    }
    if (regions.back().triangles.empty()) {
      problems.Add("--region " + request.name, "selects no triangle of the mesh", EmptyHint(request, mesh, surface));
    }
    for (const Triangle& triangle : regions.back().triangles) {
      mesh.tagged_triangles.push_back(triangle);
      mesh.triangle_tags.push_back(static_cast<std::int32_t>(i + 1));
    }
  }
  mesh.tetrahedron_tags.assign(mesh.tetrahedra.size(), static_cast<std::int32_t>(requests.size() + 1));
  return regions;
}

}  // namespace fascicle::client
