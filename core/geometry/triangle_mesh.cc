#include "core/geometry/triangle_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <limits>
#include <utility>

#include "core/geometry/bounds.h"
#include "core/geometry/surface_readers.h"
#include "core/geometry/text_scanner.h"

namespace fascicle {
namespace {

constexpr std::size_t kMaxIndex = std::numeric_limits<std::int32_t>::max();

std::string Extension(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  std::string extension(dot == std::string_view::npos ? "" : name.substr(dot));
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

// Checks node numbers and coordinates, and splits polygons into fans.
std::optional<TriangleMesh> Finish(RawSurface raw, Problems& problems) {
  if (raw.polygons.empty()) {
    problems.Add("", "the file has no triangles", "is it a surface?");
    return std::nullopt;
  }
  const std::size_t before = problems.count();
  TriangleMesh surface;
  std::size_t bad = 0, corners = 0;
  for (const auto& polygon : raw.polygons) {
    corners += polygon.size();
    const bool good = polygon.size() >= 3 && std::all_of(polygon.begin(), polygon.end(), [&](std::int64_t n) {
                        return n >= 0 && n < static_cast<std::int64_t>(raw.nodes.size());
                      });
    if (!good) ++bad;
  }
  if (bad > 0) {
    problems.Add("", std::to_string(bad) + " triangles or polygons refer to nodes that do not exist",
                 "is the file complete? It has " + std::to_string(raw.nodes.size()) + " nodes");
  }
  const auto infinite =
      std::count_if(raw.nodes.begin(), raw.nodes.end(), [](const Vec3& node) { return !node.allFinite(); });
  if (infinite > 0) {
    problems.Add("", std::to_string(infinite) + " nodes have coordinates that are not finite numbers",
                 "write the surface again");
  }
  if (raw.nodes.size() > kMaxIndex || corners > kMaxIndex) {
    problems.Add("", "the surface has more than 2^31 nodes or triangles", "use a coarser surface");
  }
  if (problems.count() > before) return std::nullopt;
  for (const auto& polygon : raw.polygons) {
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      surface.triangles.push_back({static_cast<std::int32_t>(polygon[0]), static_cast<std::int32_t>(polygon[i - 1]),
                                   static_cast<std::int32_t>(polygon[i])});
    }
  }
  surface.nodes = std::move(raw.nodes);
  return surface;
}

}  // namespace

double EnclosedVolume(const TriangleMesh& surface) {
  if (surface.triangles.empty()) return 0;
  // Relative to a point of the surface: far from the origin the terms would cancel.
  const Vec3 origin = surface.nodes[surface.triangles[0][0]];
  double volume = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    volume += (surface.nodes[a] - origin).dot((surface.nodes[b] - origin).cross(surface.nodes[c] - origin)) / 6;
  }
  return volume;
}

double Area(const TriangleMesh& surface) {
  double area = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    area += (surface.nodes[b] - surface.nodes[a]).cross(surface.nodes[c] - surface.nodes[a]).norm() / 2;
  }
  return area;
}

double Diagonal(const std::vector<Vec3>& nodes) { return BoundsOf(nodes).extent().norm(); }

std::string KnownSurfaceExtensions() { return ".stl, .obj, .ply, .vtp"; }

std::optional<TriangleMesh> ReadSurface(std::string_view name, std::string_view bytes, Problems& problems,
                                        const std::stop_token& stop) {
  const std::string extension = Extension(name);
  const std::size_t before = problems.count();
  RawSurface raw;
  if (extension == ".stl") {
    raw = ReadStl(bytes, stop, problems);
  } else if (extension == ".obj") {
    raw = ReadObj(bytes, stop, problems);
  } else if (extension == ".ply") {
    raw = ReadPly(bytes, stop, problems);
  } else if (extension == ".vtp") {
    raw = ReadVtp(bytes, stop, problems);
  } else {
    problems.Add("", "the file extension " + Quoted(extension) + " is not that of a surface that can be read",
                 "known are " + KnownSurfaceExtensions());
  }
  if (problems.count() > before) return std::nullopt;
  return Finish(std::move(raw), problems);
}

}  // namespace fascicle
