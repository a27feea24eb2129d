#include "server/translate/regions.h"

#include <optional>
#include <set>

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
                 "is " + Text(box.min(i)) + ", above the maximum " + Text(box.max(i)), "exchange min and max");
  }
  if (!ordered) return std::nullopt;
  return BoxSelector{ToVec3(box.min()) * metres, ToVec3(box.max()) * metres};
}

// The selector in metres; nothing when it is missing or wrong.
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

std::string TagHint(const TranslatedMesh& translated, bool from_file) {
  const TetMesh& mesh = translated.mesh;
  std::set<std::int32_t> tags(mesh.triangle_tags.begin(), mesh.triangle_tags.end());
  tags.insert(mesh.tetrahedron_tags.begin(), mesh.tetrahedron_tags.end());
  tags.insert(mesh.node_tags.begin(), mesh.node_tags.end());
  tags.insert(translated.bricks.labels.begin(), translated.bricks.labels.end());
  if (!from_file) return "built-in shapes have no tags; select by plane, box, sphere or side";
  if (tags.empty()) return "the mesh file has no tags; select by plane, box, sphere or side";
  constexpr std::size_t kMaxListed = 20;
  std::string hint = translated.bricks.labels.empty() ? "tags in the mesh file: " : "labels of the voxels: ";
  std::size_t listed = 0;
  for (const std::int32_t tag : tags) {
    if (listed == kMaxListed) return hint + ", ...";
    hint += (listed++ > 0 ? ", " : "") + std::to_string(tag);
  }
  return hint;
}

// The body's extent in its own unit, for a selector that misses it.
std::string ExtentHint(const TranslatedMesh& mesh, double metres) {
  const Bounds bounds = BoundsOf(mesh.nodes());
  const auto corner = [metres](const Vec3& x) {
    char text[96];
    std::snprintf(text, sizeof(text), "[%.6g, %.6g, %.6g]", x[0] / metres, x[1] / metres, x[2] / metres);
    return std::string(text);
  };
  return "in its own unit, the body reaches from " + corner(bounds.lowest) + " to " + corner(bounds.highest);
}

void AddEmptyRegion(const v1::Body& body, const v1::Region& region, const TranslatedMesh& mesh, const std::string& path,
                    Problems& problems) {
  if (region.has_physical_tag()) {
    problems.Add(JoinPath(path, "physical_tag"),
                 "nothing in the mesh has the tag " + std::to_string(region.physical_tag()),
                 TagHint(mesh, body.mesh().has_file() || body.mesh().has_image()));
  } else if (region.within_size() > 0) {
    problems.Add(JoinPath(path, "within"), "no node of the region lies in all of these regions too",
                 ExtentHint(mesh, MetresIn(body.unit())));
  } else {
    const char* kind = region.has_plane()    ? "plane"
                       : region.has_box()    ? "box"
                       : region.has_sphere() ? "sphere"
                                             : "side";
    problems.Add(JoinPath(path, kind), "selects no node of the body", ExtentHint(mesh, MetresIn(body.unit())));
  }
}

// Leaves of the last region what lies in the regions named as well.
void Restrict(const v1::Region& region, const std::string& path, TranslatedRegions& result, Problems& problems) {
  const std::size_t own = result.regions.size() - 1;
  for (int k = 0; k < region.within_size(); ++k) {
    const std::string at = JoinPath(path, IndexPath("within", static_cast<std::size_t>(k)));
    const auto other = result.names.Find(region.within(k), at, problems);
    if (!other) continue;
    if (*other == own) {
      problems.Add(at, "is the region itself", "name regions that stand before it");
      continue;
    }
    result.regions[own] = Intersection(result.regions[own], result.regions[*other]);
  }
}

}  // namespace

TranslatedRegions TranslateRegions(const v1::Body& body, const std::string& body_path, const TranslatedMesh* mesh,
                                   Problems& problems) {
  TranslatedRegions result;
  std::vector<Triangle> triangles;
  std::vector<Quad> quads;
  TetMesh bare;  // the nodes of a surface without tetrahedra
  const bool is_surface = mesh != nullptr && mesh->mesh.nodes.empty() && !mesh->surface.nodes.empty();
  if (is_surface) {
    bare.nodes = mesh->surface.nodes;
    triangles = mesh->surface.triangles;
  } else if (mesh != nullptr && body.regions_size() > 0) {
    triangles = BoundaryTriangles(mesh->mesh);
    quads = BoundaryQuads(mesh->bricks);
  }
  for (int i = 0; i < body.regions_size(); ++i) {
    const v1::Region& region = body.regions(i);
    const std::string path = JoinPath(body_path, IndexPath("regions", static_cast<std::size_t>(i)));
    result.names.Add(region.name(), JoinPath(path, "name"), problems);
    result.regions.push_back({region.name(), {}, {}, {}, {}, {}});
    const auto selector = TranslateSelector(region, MetresIn(body.unit()), path, problems);
    if (mesh != nullptr && selector) {
      result.regions.back() = mesh->bricks.bricks.empty()
                                  ? SelectRegion(is_surface ? bare : mesh->mesh, triangles, region.name(), *selector)
                                  : SelectRegion(mesh->bricks, quads, region.name(), *selector);
    }
    Problems within;
    Restrict(region, path, result, within);
    problems.Append("", within);
    if (mesh == nullptr || !selector || !within.empty()) continue;
    // Within a surface there are no nodes: whether what the region is for finds any of the grid, or of the surface, is
    // checked there.
    const bool may_be_inside = is_surface && !region.has_physical_tag() && !region.has_side();
    if (result.regions.back().nodes.empty() && !may_be_inside) AddEmptyRegion(body, region, *mesh, path, problems);
  }
  return result;
}

}  // namespace fascicle::server
