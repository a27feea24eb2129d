#include "server/translate/regions.h"

#include <algorithm>
#include <set>

#include "core/base/stop.h"
#include "core/geometry/bounds.h"
#include "server/translate/values.h"

namespace fascicle::server {
namespace {

std::optional<Selector> TranslateBox(const v1::BoxRegion& box, double metres, const std::string& path,
                                     Problems& problems) {
  bool ordered = true;
  for (int i = 0; i < std::min(box.min_size(), box.max_size()); ++i) {
    if (!(box.min(i) > box.max(i))) continue;
    ordered = false;
    problems.Add(JoinPath(path, IndexPath("min", static_cast<std::size_t>(i))),
                 "is " + Text(box.min(i)) + ", above the maximum " + Text(box.max(i)), "swap min and max");
  }
  if (!ordered) return std::nullopt;
  return BoxSelector{ToVec3(box.min()) * metres, ToVec3(box.max()) * metres};
}

// The selector in metres; nothing if it is missing or invalid.
std::optional<Selector> TranslateSelector(const v1::Region& region, double metres, const std::string& path,
                                          Problems& problems) {
  Problems own;
  std::optional<Selector> selector;
  switch (region.selector_case()) {
    case v1::Region::kPhysicalTag:
      selector = TagSelector{region.physical_tag()};
      break;
    case v1::Region::kPlane:
      selector = PlaneSelector{ToVec3(region.plane().point()) * metres,
                               ToDirection(region.plane().normal(), JoinPath(path, "plane.normal"), own)};
      break;
    case v1::Region::kBox:
      selector = TranslateBox(region.box(), metres, JoinPath(path, "box"), own);
      break;
    case v1::Region::kSphere:
      selector = SphereSelector{ToVec3(region.sphere().center()) * metres, region.sphere().radius() * metres};
      break;
    case v1::Region::kSide:
      selector = SideSelector{ToDirection(region.side().direction(), JoinPath(path, "side.direction"), own),
                              region.side().max_angle(), region.side().depth() * metres};
      break;
    case v1::Region::SELECTOR_NOT_SET:
      break;
  }
  problems.Append("", own);
  if (!own.empty() || !ObeysRules(region)) return std::nullopt;
  return selector;
}

std::string Listed(const std::string& what, const std::set<std::int32_t>& tags) {
  constexpr std::size_t kMaxTagsListed = 20;
  std::string hint = what + ": ";
  std::size_t listed = 0;
  for (const std::int32_t tag : tags) {
    if (listed == kMaxTagsListed) return hint + ", ...";
    hint += (listed++ > 0 ? ", " : "") + std::to_string(tag);
  }
  return hint;
}

const char kOtherSelectors[] = "; select by plane, box, sphere or side";

// The tags of a mesh, as a hint.
std::string TagHint(const TetMesh& mesh, const v1::Mesh& wire) {
  if (!wire.has_file()) return std::string("built-in shapes have no tags") + kOtherSelectors;
  std::set<std::int32_t> tags(mesh.triangle_tags.begin(), mesh.triangle_tags.end());
  tags.insert(mesh.tetrahedron_tags.begin(), mesh.tetrahedron_tags.end());
  tags.insert(mesh.node_tags.begin(), mesh.node_tags.end());
  for (const auto& [tetrahedron, tag] : mesh.further_tags) tags.insert(tag);
  if (tags.empty()) return std::string("the mesh file has no tags") + kOtherSelectors;
  return Listed("tags in the mesh file", tags);
}

std::string TagHint(const BrickMesh& mesh, const v1::Mesh& wire) {
  if (!wire.has_image()) return std::string("built-in shapes have no tags") + kOtherSelectors;
  return Listed("labels of the voxels", {mesh.labels.begin(), mesh.labels.end()});
}

std::string TagHint(const TriangleMesh&, const v1::Mesh&) {
  return std::string("surfaces have no tags") + kOtherSelectors;
}

// The body's extent in its own unit, as a hint for selectors that select nothing.
std::string ExtentHint(const std::vector<Vec3>& nodes, double metres) {
  const Bounds bounds = BoundsOf(nodes);
  const auto corner = [metres](const Vec3& x) {
    char text[96];
    std::snprintf(text, sizeof(text), "[%.6g, %.6g, %.6g]", x[0] / metres, x[1] / metres, x[2] / metres);
    return std::string(text);
  };
  return "in its own unit, the body extends from " + corner(bounds.lowest) + " to " + corner(bounds.highest);
}

// Limits on what the regions of a body may cost: their number, and their memory, this much and so many times that of
// the mesh.
constexpr int kMostRegions = 2000;
constexpr std::size_t kRegionBytes = 16 << 20, kRegionsPerMesh = 10;

template <class T>
std::size_t BytesOf(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}
std::size_t BytesOf(const TetMesh& mesh) {
  return BytesOf(mesh.nodes) + BytesOf(mesh.tetrahedra) + BytesOf(mesh.hexahedra);
}
std::size_t BytesOf(const BrickMesh& mesh) { return BytesOf(mesh.nodes) + BytesOf(mesh.bricks); }
std::size_t BytesOf(const TriangleMesh& mesh) { return BytesOf(mesh.nodes) + BytesOf(mesh.triangles); }
template <class Mesh>
std::size_t MostRegionBytes(const Mesh& mesh) {
  return kRegionBytes + kRegionsPerMesh * BytesOf(mesh);
}
std::size_t BytesOf(const Region& region) {
  return BytesOf(region.nodes) + BytesOf(region.triangles) + BytesOf(region.elements) + BytesOf(region.quads) +
         BytesOf(region.sides);
}

template <class Mesh>
void AddEmptyRegion(const v1::Body& body, const v1::Region& region, const Mesh& mesh, const std::string& path,
                    Problems& problems) {
  const double metres = MetresIn(body.unit());
  if (region.has_physical_tag()) {
    problems.Add(JoinPath(path, "physical_tag"),
                 "no element of the mesh has the tag " + std::to_string(region.physical_tag()),
                 TagHint(mesh, body.mesh()));
  } else if (region.within_size() > 0) {
    problems.Add(JoinPath(path, "within"), "no node of the region belongs to all of these regions",
                 ExtentHint(mesh.nodes, metres));
  } else {
    const char* kind = region.has_plane()    ? "plane"
                       : region.has_box()    ? "box"
                       : region.has_sphere() ? "sphere"
                                             : "side";
    problems.Add(JoinPath(path, kind), "selects no node of the body", ExtentHint(mesh.nodes, metres));
  }
}

// Whether a region may be valid without nodes of the mesh because it is inside of a surface. Whether it contains grid
// points is checked where it is used.
bool MayBeInside(const v1::Region&, const TetMesh&) { return false; }
bool MayBeInside(const v1::Region&, const BrickMesh&) { return false; }
bool MayBeInside(const v1::Region& region, const TriangleMesh&) {
  return !region.has_physical_tag() && !region.has_side();
}

// The indices of the regions to which this one is restricted. False if one of them is invalid.
bool TranslateWithin(const v1::Region& region, const Names& names, std::size_t own, const std::string& path,
                     std::vector<std::size_t>& within, Problems& problems) {
  bool complete = true;
  for (int k = 0; k < region.within_size(); ++k) {
    const std::string at = JoinPath(path, IndexPath("within", static_cast<std::size_t>(k)));
    const auto other = names.Find(region.within(k), at, problems);
    if (other && *other != own) {
      within.push_back(*other);
      continue;
    }
    complete = false;
    if (other) problems.Add(at, "refers to the region itself", "refer to earlier regions");
  }
  return complete;
}

std::vector<Quad> FacesOf(const BrickMesh& mesh, const std::stop_token& stop) { return BoundaryQuads(mesh, stop); }
// The surface as a mesh without elements.
TetMesh FacesOf(const TriangleMesh& mesh, const std::stop_token&) {
  return {mesh.nodes, {}, {}, {}, {}, {}, {}, {}, {}, {}};
}

template <class Mesh, class Faces>
Region Select(const Mesh& mesh, const Faces& faces, const std::string& name, const Selector& selector) {
  return SelectRegion(mesh, faces, name, selector);
}
Region Select(const TriangleMesh& mesh, const TetMesh& nodes, const std::string& name, const Selector& selector) {
  return SelectRegion(nodes, mesh.triangles, name, selector);
}

}  // namespace

RegionSelectors TranslateRegions(const v1::Body& body, const std::string& body_path, Problems& problems) {
  RegionSelectors result;
  if (body.regions_size() > kMostRegions) {
    problems.Add(
        JoinPath(body_path, "regions"),
        "are " + std::to_string(body.regions_size()) + ", at most " + std::to_string(kMostRegions) + " are allowed",
        "select several places by one region, or use several bodies");
  }
  for (int i = 0; i < body.regions_size(); ++i) {
    const v1::Region& region = body.regions(i);
    const std::string path = JoinPath(body_path, IndexPath("regions", static_cast<std::size_t>(i)));
    result.names.Add(region.name(), JoinPath(path, "name"), problems);
    RegionSelectors::Entry& entry = result.entries.emplace_back();
    entry.name = region.name();
    if (i >= kMostRegions) continue;
    entry.selector = TranslateSelector(region, MetresIn(body.unit()), path, problems);
    const bool within = TranslateWithin(region, result.names, result.entries.size() - 1, path, entry.within, problems);
    entry.complete = entry.selector && within;
  }
  return result;
}

// The boundary of hexahedra, or the triangles of other meshes.
template <class Select>
void VisitFaces(const TetMesh& mesh, const std::stop_token& stop, const Select& select) {
  mesh.hexahedra.empty() ? select(BoundaryTriangles(mesh, stop)) : select(BoundaryOfHexahedra(mesh, stop));
}
template <class Mesh, class Select>
void VisitFaces(const Mesh& mesh, const std::stop_token& stop, const Select& select) {
  select(FacesOf(mesh, stop));
}

template <class Mesh>
std::vector<Region> SelectRegions(const RegionSelectors& selectors, const Mesh& mesh, const std::stop_token& stop) {
  std::vector<Region> regions;
  if (selectors.entries.empty()) return regions;
  const std::size_t most_bytes = MostRegionBytes(mesh);
  std::size_t bytes = 0;
  VisitFaces(mesh, stop, [&](const auto& faces) {
    for (const RegionSelectors::Entry& entry : selectors.entries) {
      ThrowIfStopped(stop);
      Region region;
      region.name = entry.name;
      if (entry.selector && bytes <= most_bytes) region = Select(mesh, faces, entry.name, *entry.selector);
      bytes += BytesOf(region);
      for (const std::size_t other : entry.within) region = Intersection(region, regions[other]);
      regions.push_back(std::move(region));
    }
  });
  return regions;
}
template std::vector<Region> SelectRegions(const RegionSelectors& selectors, const TetMesh& mesh,
                                           const std::stop_token& stop);
template std::vector<Region> SelectRegions(const RegionSelectors& selectors, const BrickMesh& mesh,
                                           const std::stop_token& stop);
template std::vector<Region> SelectRegions(const RegionSelectors& selectors, const TriangleMesh& mesh,
                                           const std::stop_token& stop);

std::vector<Region> EmptyRegions(const RegionSelectors& selectors) {
  std::vector<Region> regions;
  for (const RegionSelectors::Entry& entry : selectors.entries) regions.emplace_back().name = entry.name;
  return regions;
}

template <class Mesh>
void CheckRegions(const v1::Body& body, const std::string& body_path, const RegionSelectors& selectors,
                  const std::vector<Region>& regions, const Mesh& mesh, Problems& problems) {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (bytes > MostRegionBytes(mesh)) {
      problems.Add(JoinPath(body_path, IndexPath("regions", i)),
                   "the regions before it take several times as much memory as the mesh",
                   "use fewer or smaller regions");
      return;
    }
    bytes += BytesOf(regions[i]);
    const v1::Region& wire = body.regions(static_cast<int>(i));
    if (!selectors.entries[i].complete || !regions[i].nodes.empty() || MayBeInside(wire, mesh)) continue;
    AddEmptyRegion(body, wire, mesh, JoinPath(body_path, IndexPath("regions", i)), problems);
  }
}
template void CheckRegions(const v1::Body& body, const std::string& body_path, const RegionSelectors& selectors,
                           const std::vector<Region>& regions, const TetMesh& mesh, Problems& problems);
template void CheckRegions(const v1::Body& body, const std::string& body_path, const RegionSelectors& selectors,
                           const std::vector<Region>& regions, const BrickMesh& mesh, Problems& problems);
template void CheckRegions(const v1::Body& body, const std::string& body_path, const RegionSelectors& selectors,
                           const std::vector<Region>& regions, const TriangleMesh& mesh, Problems& problems);

}  // namespace fascicle::server
