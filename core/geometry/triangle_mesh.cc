#include "core/geometry/triangle_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "core/base/letters.h"
#include "core/geometry/bounds.h"
#include "core/geometry/ear_clipping.h"
#include "core/geometry/surface_readers.h"
#include "core/geometry/text_scanner.h"

namespace fascicle {
namespace {

constexpr std::size_t kMaxCorners = std::numeric_limits<std::int32_t>::max();

bool IsVolumeMesh(std::string_view extension) {
  constexpr std::string_view kExtensions[] = {".msh", ".vtu", ".vtk", ".mesh", ".node", ".inp", ".feb", ".e", ".exo"};
  return std::find(std::begin(kExtensions), std::end(kExtensions), extension) != std::end(kExtensions);
}

// Checks node numbers and coordinates, and splits polygons into triangles.
std::optional<TriangleMesh> Finish(RawSurface raw, const std::stop_token& stop, Problems& problems) {
  if (raw.polygons.empty()) {
    problems.Add("", "the file has no triangles", "is it a surface?");
    return std::nullopt;
  }
  const std::size_t before = problems.count();
  TriangleMesh surface;
  std::size_t bad = 0, corners = 0, most = 0;
  for (const auto& polygon : raw.polygons) {
    corners += polygon.size();
    most = std::max(most, polygon.size());
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
  if (raw.nodes.size() > kMaxCorners || corners > kMaxCorners) {
    problems.Add("", "the surface has more than 2^31 nodes or triangles", "use a coarser surface");
  }
  if (most > kMostCorners) {
    problems.Add("",
                 "the surface has a polygon of " + std::to_string(most) + " corners; " + std::to_string(kMostCorners) +
                     " are the most",
                 "split it into triangles");
  }
  if (problems.count() > before) return std::nullopt;
  for (const auto& polygon : raw.polygons) {
    if (polygon.size() == 3) {
      surface.triangles.push_back({static_cast<std::int32_t>(polygon[0]), static_cast<std::int32_t>(polygon[1]),
                                   static_cast<std::int32_t>(polygon[2])});
      continue;
    }
    const std::vector<Triangle> split = SplitPolygon(raw.nodes, polygon, stop);
    surface.triangles.insert(surface.triangles.end(), split.begin(), split.end());
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
                                        const std::stop_token& stop, std::vector<std::string>* notes) {
  const std::string extension = LowerExtension(name);
  const std::size_t before = problems.count();
  RawSurface raw;
  if (extension == ".stl") {
    raw = ReadStl(bytes, stop, problems);
  } else if (extension == ".obj") {
    raw = ReadObj(WithoutByteOrderMark(bytes), stop, problems);
  } else if (extension == ".ply") {
    raw = ReadPly(WithoutByteOrderMark(bytes), stop, problems);
  } else if (extension == ".vtp") {
    raw = ReadVtp(WithoutByteOrderMark(bytes), stop, problems);
  } else {
    problems.Add(
        "", "the file extension " + Quoted(extension) + " is not that of a surface that can be read",
        "known are " + KnownSurfaceExtensions() +
            (IsVolumeMesh(extension) ? "; `fascicle mesh FILE --convert --out FILE.msh` converts volume meshes" : ""));
  }
  if (problems.count() > before) return std::nullopt;
  if (notes != nullptr) notes->insert(notes->end(), raw.notes.begin(), raw.notes.end());
  return Finish(std::move(raw), stop, problems);
}

}  // namespace fascicle
