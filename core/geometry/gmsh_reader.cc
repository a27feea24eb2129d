// Gmsh MSH, ASCII, versions 2 and 4.1 [Gmsh reference manual, "Gmsh mesh file formats"].
#include <map>
#include <string>
#include <utility>

#include "core/geometry/mesh_readers.h"
#include "core/geometry/text_scanner.h"

namespace fascicle {
namespace {

// Gmsh's element types.
constexpr std::int64_t kTriangle3 = 2, kTetrahedron4 = 4, kTriangle6 = 9, kTetrahedron10 = 11, kPoint = 15;
bool IsHigherTetrahedron(std::int64_t type) { return type >= 29 && type <= 31; }

// Physical tags of version 4's entities, by dimension and tag.
using EntityTags = std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t>;

void ReadFormat(TextScanner& in, double& version) {
  version = in.Double("the version");
  const std::int64_t file_type = in.Int("the file type");
  in.Line();
  if (in.failed()) return;
  if (file_type != 0) {
    in.Fail("the file is binary", "write it as ASCII, for example with `gmsh -0 -format msh41 -bin 0`");
  } else if (!(version >= 2 && version < 3) && version != 4.1) {
    char text[32];
    std::snprintf(text, sizeof(text), "%g", version);
    in.Fail("the format's version is " + std::string(text), "write version 2.2 or 4.1");
  }
  in.Expect("$EndMeshFormat");
}

void ReadNodes2(TextScanner& in, RawMesh& raw) {
  const std::size_t count = in.Count("nodes", 8);
  raw.node_numbers.reserve(count);
  raw.nodes.reserve(count);
  for (std::size_t i = 0; i < count && !in.failed(); ++i) {
    raw.node_numbers.push_back(in.Int("a node number"));
    const double x = in.Double("a coordinate"), y = in.Double("a coordinate"), z = in.Double("a coordinate");
    raw.nodes.emplace_back(x, y, z);
  }
}

void AddElement(TextScanner& in, std::int64_t type, std::int64_t tag, RawMesh& raw) {
  if (type == kTetrahedron4 || type == kTetrahedron10) {
    auto& nodes = raw.tetrahedra.emplace_back();
    for (std::int64_t& node : nodes) node = in.Int("a node number");
    raw.tetrahedron_tags.push_back(tag);
    if (type == kTetrahedron4) return;
    auto& middles = raw.middles.emplace_back();
    for (std::int64_t& node : middles) node = in.Int("a node number");
    std::swap(middles[4], middles[5]);  // Gmsh has edge 2-3 before edge 1-3
  } else if (type == kTriangle3 || type == kTriangle6) {
    auto& nodes = raw.triangles.emplace_back();
    for (std::int64_t& node : nodes) node = in.Int("a node number");
    for (int middle = 0; type == kTriangle6 && middle < 3; ++middle) in.Int("a node number");
    raw.triangle_tags.push_back(tag);
  } else if (type == kPoint) {
    raw.points.push_back({in.Int("a node number")});
    raw.point_tags.push_back(tag);
  } else {
    ++(IsHigherTetrahedron(type) ? raw.higher_order : raw.others);
    in.Line();
  }
}

void ReadElements2(TextScanner& in, RawMesh& raw) {
  const std::size_t count = in.Count("elements", 6);
  for (std::size_t i = 0; i < count && !in.failed(); ++i) {
    in.Int("an element number");
    const std::int64_t type = in.Int("an element type");
    const std::size_t tags = in.Count("tags", 2);
    std::int64_t physical = 0;
    for (std::size_t t = 0; t < tags; ++t) {
      const std::int64_t tag = in.Int("a tag");
      if (t == 0) physical = tag;
    }
    AddElement(in, type, physical, raw);
  }
}

// Reads points, curves, surfaces and volumes: tag, a point or a bounding box, physical tags, bounding entities.
void ReadEntities(TextScanner& in, EntityTags& tags) {
  std::size_t counts[4];
  for (std::size_t& count : counts) count = in.Count("entities", 8);
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (std::size_t i = 0; i < counts[dimension] && !in.failed(); ++i) {
      const std::int64_t entity = in.Int("an entity tag");
      for (int c = 0; c < (dimension == 0 ? 3 : 6); ++c) in.Double("a bound");
      const std::size_t physicals = in.Count("physical tags", 2);
      for (std::size_t p = 0; p < physicals; ++p) {
        const std::int64_t physical = in.Int("a physical tag");
        // Gmsh gives a negative tag to an entity that is used against its orientation.
        if (p == 0) tags[{dimension, entity}] = physical < 0 ? -physical : physical;
      }
      if (dimension == 0) continue;
      const std::size_t bounds = in.Count("bounding entities", 2);
      for (std::size_t b = 0; b < bounds && !in.failed(); ++b) in.Int("a bounding entity");
    }
  }
}

void ReadNodes4(TextScanner& in, RawMesh& raw) {
  const std::size_t blocks = in.Count("node blocks", 8);
  const std::size_t count = in.Count("nodes", 8);
  in.Int("the smallest node number");
  in.Int("the largest node number");
  raw.node_numbers.reserve(count);
  raw.nodes.reserve(count);
  for (std::size_t block = 0; block < blocks && !in.failed(); ++block) {
    const std::int64_t dimension = in.Int("a dimension");
    in.Int("an entity tag");
    const std::int64_t parametric = in.Int("a parametric flag");
    const std::size_t in_block = in.Count("nodes", 8);
    if (!in.failed() && (dimension < 0 || dimension > 3))
      in.Fail("an entity of dimension " + std::to_string(dimension));
    for (std::size_t i = 0; i < in_block && !in.failed(); ++i) raw.node_numbers.push_back(in.Int("a node number"));
    for (std::size_t i = 0; i < in_block && !in.failed(); ++i) {
      const double x = in.Double("a coordinate"), y = in.Double("a coordinate"), z = in.Double("a coordinate");
      raw.nodes.emplace_back(x, y, z);
      for (int p = 0; parametric != 0 && p < dimension; ++p) in.Double("a parametric coordinate");
    }
  }
  if (!in.failed() && raw.nodes.size() != count) {
    in.Fail(std::to_string(count) + " nodes are announced, but the blocks have " + std::to_string(raw.nodes.size()));
  }
}

void ReadElements4(TextScanner& in, const EntityTags& tags, RawMesh& raw) {
  const std::size_t blocks = in.Count("element blocks", 8);
  const std::size_t count = in.Count("elements", 4);
  in.Int("the smallest element number");
  in.Int("the largest element number");
  std::size_t found = 0;
  for (std::size_t block = 0; block < blocks && !in.failed(); ++block) {
    const std::int64_t dimension = in.Int("a dimension");
    const std::int64_t entity = in.Int("an entity tag");
    const std::int64_t type = in.Int("an element type");
    const std::size_t in_block = in.Count("elements", 4);
    const auto tag = tags.find({dimension, entity});
    for (std::size_t i = 0; i < in_block && !in.failed(); ++i) {
      in.Int("an element number");
      AddElement(in, type, tag == tags.end() ? 0 : tag->second, raw);
    }
    found += in_block;
  }
  if (!in.failed() && found != count) {
    in.Fail(std::to_string(count) + " elements are announced, but the blocks have " + std::to_string(found));
  }
}

void SkipSection(TextScanner& in, std::string_view name) {
  const std::string end = "$End" + std::string(name.substr(1));
  while (!in.AtEnd()) {
    if (in.Token() == end) return;
    in.Line();
  }
  in.Fail("the section " + Quoted(name) + " does not end", "is the file complete?");
}

}  // namespace

RawMesh ReadGmsh(std::string_view bytes, const std::stop_token& stop, Problems& problems) {
  RawMesh raw;
  EntityTags tags;
  double version = 0;
  bool has_nodes = false, has_elements = false;
  TextScanner in(bytes, problems, '\0', stop);
  while (!in.failed() && !in.AtEnd()) {
    const std::string_view section = in.Token();
    if (version == 0 && section != "$MeshFormat" && section != "$Comments") {
      in.Fail("expected $MeshFormat but found " + Quoted(section), "is this a Gmsh file of version 2 or 4?");
    } else if (section == "$MeshFormat" && version == 0) {
      ReadFormat(in, version);
    } else if (section == "$Nodes" && !has_nodes) {
      has_nodes = true;
      version < 4 ? ReadNodes2(in, raw) : ReadNodes4(in, raw);
      in.Expect("$EndNodes");
    } else if (section == "$Elements" && !has_elements) {
      has_elements = true;
      version < 4 ? ReadElements2(in, raw) : ReadElements4(in, tags, raw);
      in.Expect("$EndElements");
    } else if (section == "$Entities" && version >= 4) {
      ReadEntities(in, tags);
      in.Expect("$EndEntities");
    } else if (section == "$MeshFormat" || section == "$Nodes" || section == "$Elements") {
      in.Fail("a second section " + std::string(section));
    } else if (section.starts_with('$')) {
      SkipSection(in, section);
    } else {
      in.Fail("expected a section such as $Nodes but found " + Quoted(section));
    }
  }
  if (in.failed()) return raw;
  if (version == 0) in.Fail("the file is empty");
  if (!has_nodes) in.Fail("the file has no section $Nodes", "is the file complete?");
  if (!has_elements) in.Fail("the file has no section $Elements", "is the file complete?");
  return raw;
}

}  // namespace fascicle
