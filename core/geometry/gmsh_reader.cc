// Gmsh MSH, ASCII, versions 2 and 4.1 [Gmsh reference manual, "Gmsh mesh file formats"].
#include <algorithm>
#include <cstdio>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "core/base/stop.h"
#include "core/geometry/gmsh_types.h"
#include "core/geometry/mesh_readers.h"
#include "core/geometry/text_scanner.h"

namespace fascicle {
namespace {

bool IsHigherTetrahedron(std::int64_t type) { return type >= 29 && type <= 31; }
// Other solids of order three and more.
bool IsHigherSolid(std::int64_t type) { return (type >= 90 && type <= 98) || (type >= 106 && type <= 125); }
constexpr std::int64_t kGmshQuads[] = {3, 10, 16};
struct GmshSolid {
  std::int64_t type;
  SolidShape shape;
  int nodes;
};
constexpr GmshSolid kGmshSolids[] = {
    {5, SolidShape::kHexahedron, 8},   {6, SolidShape::kWedge, 6},   {7, SolidShape::kPyramid, 5},
    {12, SolidShape::kHexahedron, 27}, {13, SolidShape::kWedge, 18}, {14, SolidShape::kPyramid, 14},
    {17, SolidShape::kHexahedron, 20}, {18, SolidShape::kWedge, 15}, {19, SolidShape::kPyramid, 13}};

using PhysicalTags = std::vector<std::int64_t>;

// Physical tags of version 4's entities, by dimension and tag.
using EntityTags = std::map<std::pair<std::int64_t, std::int64_t>, PhysicalTags>;

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

std::int64_t FirstOf(const PhysicalTags& tags) { return tags.empty() ? 0 : tags.front(); }

// Adds a surface cell or a point once for each of its tags.
template <std::size_t N>
void AddForEachTag(const std::array<std::int64_t, N>& nodes, const PhysicalTags& tags,
                   std::vector<std::array<std::int64_t, N>>& cells, std::vector<std::int64_t>& cell_tags) {
  for (std::size_t t = 0; t < std::max<std::size_t>(tags.size(), 1); ++t) {
    cells.push_back(nodes);
    cell_tags.push_back(tags.empty() ? 0 : tags[t]);
  }
}

template <std::size_t N>
std::array<std::int64_t, N> ReadNodeNumbers(TextScanner& in) {
  std::array<std::int64_t, N> nodes;
  for (std::int64_t& node : nodes) node = in.Int("a node number");
  return nodes;
}

void AddTetrahedron(TextScanner& in, bool ten_nodes, const PhysicalTags& tags, RawMesh& raw) {
  raw.tetrahedra.push_back(ReadNodeNumbers<4>(in));
  raw.tetrahedron_tags.push_back(FirstOf(tags));
  for (std::size_t t = 1; t < tags.size(); ++t) {
    raw.further_tags.push_back({static_cast<std::int64_t>(raw.tetrahedra.size()) - 1, tags[t]});
  }
  if (!ten_nodes) return;
  raw.middles.push_back(ReadNodeNumbers<6>(in));
  std::swap(raw.middles.back()[4], raw.middles.back()[5]);  // Gmsh has edge 2-3 before edge 1-3
}

void AddSolid(TextScanner& in, const GmshSolid& type, const PhysicalTags& tags, RawMesh& raw) {
  RawSolid solid{type.shape, {}};
  const int corners = CornersOf(type.shape);
  for (int n = 0; n < corners; ++n) solid.nodes[n] = in.Int("a node number");
  std::vector<std::int64_t> higher;
  for (int n = corners; n < type.nodes; ++n) higher.push_back(in.Int("a node number"));
  if (type.shape == SolidShape::kHexahedron && higher.size() >= 12) {
    // Gmsh has the edges of each corner one after the other.
    constexpr std::array<std::size_t, 12> kOrder = {0, 3, 5, 1, 8, 10, 11, 9, 2, 4, 6, 7};
    solid.middles.emplace();
    for (std::size_t k = 0; k < 12; ++k) (*solid.middles)[k] = higher[kOrder[k]];
    raw.inner_nodes += higher.size() - 12;
  }
  if (type.nodes > corners) ++raw.curved_solids;
  raw.solids.push_back(solid);
  raw.solid_tags.push_back(FirstOf(tags));
  for (std::size_t t = 1; t < tags.size(); ++t) {
    raw.further_solid_tags.push_back({static_cast<std::int64_t>(raw.solids.size()) - 1, tags[t]});
  }
}

void AddElement(TextScanner& in, std::int64_t type, const PhysicalTags& tags, RawMesh& raw) {
  const auto solid =
      std::find_if(std::begin(kGmshSolids), std::end(kGmshSolids), [&](const GmshSolid& s) { return s.type == type; });
  if (type == gmsh::kTetrahedron4 || type == gmsh::kTetrahedron10) {
    AddTetrahedron(in, type == gmsh::kTetrahedron10, tags, raw);
  } else if (type == gmsh::kTriangle3 || type == gmsh::kTriangle6) {
    AddForEachTag(ReadNodeNumbers<3>(in), tags, raw.triangles, raw.triangle_tags);
    for (int middle = 0; type == gmsh::kTriangle6 && middle < 3; ++middle) in.Int("a node number");
  } else if (type == gmsh::kPoint) {
    AddForEachTag(ReadNodeNumbers<1>(in), tags, raw.points, raw.point_tags);
  } else if (std::find(std::begin(kGmshQuads), std::end(kGmshQuads), type) != std::end(kGmshQuads)) {
    AddForEachTag(ReadNodeNumbers<4>(in), tags, raw.quads, raw.quad_tags);
    if (type != kGmshQuads[0]) in.Line();
  } else if (solid != std::end(kGmshSolids)) {
    AddSolid(in, *solid, tags, raw);
  } else {
    ++(IsHigherTetrahedron(type) ? raw.higher_order : IsHigherSolid(type) ? raw.other_solids : raw.others);
    in.Line();
  }
}

void ReadElements2(TextScanner& in, RawMesh& raw) {
  const std::size_t count = in.Count("elements", 6);
  for (std::size_t i = 0; i < count && !in.failed(); ++i) {
    in.Int("an element number");
    const std::int64_t type = in.Int("an element type");
    const std::size_t tags = in.Count("tags", 2);
    PhysicalTags physical;
    for (std::size_t t = 0; t < tags; ++t) {
      const std::int64_t tag = in.Int("a tag");
      if (t == 0) physical = {tag};
    }
    AddElement(in, type, physical, raw);
  }
}

// Version 2 has one physical tag for each element, so Gmsh writes elements of several groups once for each. Such twins
// become further tags of the first one. Twins with the same tag are left for CheckMesh to report. Returns which cells
// are to be removed.
template <class Cells>
std::vector<char> FindTwins(const Cells& cells, const PhysicalTags& tags, const std::stop_token& stop,
                            std::vector<std::array<std::int64_t, 2>>& further) {
  std::vector<char> gone(cells.size());
  if (std::all_of(tags.begin(), tags.end(), [&](std::int64_t tag) { return tag == tags.front(); })) return gone;
  std::vector<std::pair<typename Cells::value_type, std::size_t>> order;
  order.reserve(cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    order.push_back({cells[c], c});
    std::sort(order.back().first.begin(), order.back().first.end());
  }
  SortUnlessStopped(order, stop);
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first + 1;
    std::set<std::int64_t> seen = {tags[order[first].second]};
    for (; last < order.size() && order[last].first == order[first].first; ++last) {
      const std::size_t twin = order[last].second;
      if (!seen.insert(tags[twin]).second) continue;
      gone[twin] = 1;
      further.push_back({static_cast<std::int64_t>(order[first].second), tags[twin]});
    }
    first = last;
  }
  return gone;
}

// Removes the cells that are gone, and renumbers those with further tags.
template <class Cell>
void Remove(const std::vector<char>& gone, std::vector<Cell>& cells) {
  std::size_t c = 0;
  std::erase_if(cells, [&](const Cell&) { return gone[c++] != 0; });
}

void Renumber(const std::vector<char>& gone, std::vector<std::array<std::int64_t, 2>>& further) {
  std::vector<std::int64_t> number;
  std::int64_t count = 0;
  for (const char is_gone : gone) number.push_back(is_gone ? -1 : count++);
  for (auto& [cell, tag] : further) cell = number[static_cast<std::size_t>(cell)];
  std::sort(further.begin(), further.end());
}

void MergeTwins(const std::stop_token& stop, RawMesh& raw) {
  const std::vector<char> gone = FindTwins(raw.tetrahedra, raw.tetrahedron_tags, stop, raw.further_tags);
  std::vector<std::array<std::int64_t, 8>> solids;
  for (const RawSolid& solid : raw.solids) solids.push_back(solid.nodes);
  const std::vector<char> gone_solids = FindTwins(solids, raw.solid_tags, stop, raw.further_solid_tags);
  const std::size_t count = raw.further_tags.size() + raw.further_solid_tags.size();
  if (count == 0) return;
  if (raw.middles.size() == raw.tetrahedra.size()) Remove(gone, raw.middles);
  Remove(gone, raw.tetrahedra);
  Remove(gone, raw.tetrahedron_tags);
  Renumber(gone, raw.further_tags);
  Remove(gone_solids, raw.solids);
  Remove(gone_solids, raw.solid_tags);
  Renumber(gone_solids, raw.further_solid_tags);
  raw.notes.push_back(std::to_string(count) +
                      " volume elements repeat another one with a different physical tag: each is read once, with all "
                      "of its tags");
}

// Names of physical tags, a line each: dimension, tag, and the name in quotes.
void ReadNames(TextScanner& in, RawMesh& raw) {
  in.Int("the number of names");
  in.Line();
  while (!in.failed() && !in.AtEnd() && in.Peek() != "$EndPhysicalNames") {
    TagName name;
    name.dimension = static_cast<int>(in.Int("a dimension"));
    name.tag = static_cast<std::int32_t>(in.Int("a physical tag"));
    const std::string_view line = in.Line();
    const std::size_t begin = line.find('"'), end = line.rfind('"');
    if (begin == std::string_view::npos || end <= begin) continue;
    name.name = line.substr(begin + 1, end - begin - 1);
    raw.names.push_back(std::move(name));
  }
  in.Expect("$EndPhysicalNames");
}

// Reads points, curves, surfaces and volumes: tag, a point or a bounding box, physical tags, bounding entities. Those
// of a partitioned mesh have their parent entity and their partitions after the tag; without physical tags of their
// own, they have those of the parent.
void ReadEntities(TextScanner& in, bool partitioned, EntityTags& all) {
  if (partitioned) {
    in.Int("the number of partitions");
    const std::size_t ghosts = in.Count("ghost entities", 4);
    for (std::size_t i = 0; i < 2 * ghosts && !in.failed(); ++i) in.Int("a ghost entity");
  }
  std::size_t counts[4];
  for (std::size_t& count : counts) count = in.Count("entities", 8);
  for (std::int64_t dimension = 0; dimension < 4; ++dimension) {
    for (std::size_t i = 0; i < counts[dimension] && !in.failed(); ++i) {
      const std::int64_t entity = in.Int("an entity tag");
      PhysicalTags tags;
      if (partitioned) {
        const std::int64_t parent_dimension = in.Int("the dimension of the parent");
        const std::int64_t parent = in.Int("the tag of the parent");
        const auto found = all.find({parent_dimension, parent});
        if (found != all.end() && parent_dimension == dimension) tags = found->second;
        const std::size_t partitions = in.Count("partitions", 2);
        for (std::size_t p = 0; p < partitions && !in.failed(); ++p) in.Int("a partition");
      }
      for (int c = 0; c < (dimension == 0 ? 3 : 6); ++c) in.Double("a bound");
      const std::size_t physicals = in.Count("physical tags", 2);
      if (physicals > 0) tags.clear();
      for (std::size_t p = 0; p < physicals && !in.failed(); ++p) {
        const std::int64_t physical = in.Int("a physical tag");
        // Gmsh gives a negative tag to an entity that is used against its orientation.
        const std::int64_t tag = physical < 0 ? -physical : physical;
        if (std::find(tags.begin(), tags.end(), tag) == tags.end()) tags.push_back(tag);
      }
      all[{dimension, entity}] = std::move(tags);
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
      AddElement(in, type, tag == tags.end() ? PhysicalTags() : tag->second, raw);
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
      ReadEntities(in, false, tags);
      in.Expect("$EndEntities");
    } else if (section == "$PartitionedEntities" && version >= 4) {
      ReadEntities(in, true, tags);
      in.Expect("$EndPartitionedEntities");
    } else if (section == "$PhysicalNames") {
      ReadNames(in, raw);
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
  if (!in.failed() && version < 4) MergeTwins(stop, raw);
  return raw;
}

}  // namespace fascicle
