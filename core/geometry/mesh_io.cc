#include "core/geometry/mesh_io.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "core/base/letters.h"
#include "core/base/stop.h"
#include "core/geometry/mesh_readers.h"
#include "core/geometry/quadratic_hexahedron.h"
#include "core/geometry/text_scanner.h"

namespace fascicle {
namespace {

constexpr std::int64_t kMaxIndex = std::numeric_limits<std::int32_t>::max();

// Orders the nodes by number. False when a number occurs twice.
bool SortNodes(RawMesh& raw, const std::stop_token& stop, Problems& problems) {
  std::vector<std::int64_t>& numbers = raw.node_numbers;
  if (!std::is_sorted(numbers.begin(), numbers.end())) {
    std::vector<std::size_t> order(numbers.size());
    std::iota(order.begin(), order.end(), 0);
    SortUnlessStopped(order, stop, [&](std::size_t a, std::size_t b) { return numbers[a] < numbers[b]; });
    std::vector<Vec3> nodes(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) nodes[i] = raw.nodes[order[i]];
    raw.nodes = std::move(nodes);
    SortUnlessStopped(numbers, stop);
  }
  const auto twin = std::adjacent_find(numbers.begin(), numbers.end());
  if (twin == numbers.end()) return true;
  problems.Add("", "node " + std::to_string(*twin) + " is given twice", "number the nodes uniquely");
  return false;
}

// Finds nodes by number.
class NodeFinder {
 public:
  explicit NodeFinder(const RawMesh& raw)
      : numbers_(raw.node_numbers), first_(raw.first_node), count_(raw.nodes.size()) {
    if (numbers_.empty()) return;
    first_ = numbers_.front();
    // The numbers are sorted and unique, and their range does not overflow, so they are contiguous exactly if the range
    // is as long as their count.
    contiguous_ = std::uint64_t(numbers_.back()) - std::uint64_t(first_) == count_ - 1;
  }

  // Index, or -1.
  std::int32_t Find(std::int64_t number) const {
    if (contiguous_) {
      const std::uint64_t index = std::uint64_t(number) - std::uint64_t(first_);
      return index < count_ ? static_cast<std::int32_t>(index) : -1;
    }
    const auto found = std::lower_bound(numbers_.begin(), numbers_.end(), number);
    return found != numbers_.end() && *found == number ? static_cast<std::int32_t>(found - numbers_.begin()) : -1;
  }

 private:
  const std::vector<std::int64_t>& numbers_;
  std::int64_t first_;
  std::size_t count_;
  bool contiguous_ = true;
};

// Looks up the nodes of cells. Reports the first node that does not exist and how many cells refer to such a node.
template <std::size_t N>
void FindNodes(const NodeFinder& finder, const std::vector<std::array<std::int64_t, N>>& cells,
               std::vector<std::array<std::int32_t, N>>& found, const char* kind, const std::stop_token& stop,
               Problems& problems) {
  std::size_t bad = 0, first_bad = 0;
  std::int64_t missing = 0;
  found.resize(cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    ThrowIfStopped(stop);
    bool complete = true;
    for (std::size_t i = 0; i < N; ++i) {
      found[c][i] = finder.Find(cells[c][i]);
      if (found[c][i] >= 0) continue;
      if (bad == 0 && complete) missing = cells[c][i];
      complete = false;
    }
    if (!complete && bad++ == 0) first_bad = c;
  }
  if (bad == 0) return;
  problems.Add("",
               std::to_string(bad) + " " + kind + " refer to nodes that do not exist: the first is number " +
                   std::to_string(first_bad) + " (counted from 0), which refers to node " + std::to_string(missing),
               "is the file complete, and does its numbering start where the format says?");
}

// Tags as 32-bit numbers; empty when all are zero, which means that there are no tags.
std::vector<std::int32_t> NarrowTags(const std::vector<std::int64_t>& tags, Problems& problems) {
  if (std::all_of(tags.begin(), tags.end(), [](std::int64_t tag) { return tag == 0; })) return {};
  std::vector<std::int32_t> narrow(tags.size());
  for (std::size_t i = 0; i < tags.size(); ++i) {
    narrow[i] = static_cast<std::int32_t>(tags[i]);
    if (narrow[i] == tags[i]) continue;
    problems.Add("", "the physical tag " + std::to_string(tags[i]) + " does not fit 32 bits", "use smaller tags");
    return {};
  }
  return narrow;
}

void ReportNothingToRead(const RawMesh& raw, Problems& problems) {
  std::string left_out;
  if (raw.higher_order > 0) left_out = std::to_string(raw.higher_order) + " of higher order";
  const std::size_t rest = raw.others + raw.other_solids + raw.triangles.size() + raw.quads.size() + raw.points.size();
  if (rest > 0) left_out += (left_out.empty() ? "" : " and ") + std::to_string(rest) + " cells of other kinds";
  problems.Add("", "the file has no tetrahedra of four or ten nodes" + (left_out.empty() ? "" : ", but " + left_out),
               raw.higher_order > 0 ? "write the mesh with element order 1, or 2 in the formats of Gmsh and VTK"
                                    : "fill the surface with tetrahedra, and write the volume elements");
}

// "12 hexahedra, 3 wedges".
std::string CountSolids(const std::vector<RawSolid>& solids) {
  std::string text;
  for (const auto& [shape, name] :
       {std::pair(SolidShape::kHexahedron, "hexahedra"), std::pair(SolidShape::kWedge, "wedges"),
        std::pair(SolidShape::kPyramid, "pyramids")}) {
    const auto count =
        std::count_if(solids.begin(), solids.end(), [&, shape = shape](const RawSolid& s) { return s.shape == shape; });
    if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + name;
  }
  return text;
}

// Whether the mesh consists of hexahedra with mid-edge nodes. Beside wedges and pyramids, these are left out.
bool HasMiddles(const RawMesh& raw) {
  const auto is_hexahedron = [](const RawSolid& solid) { return solid.shape == SolidShape::kHexahedron; };
  const auto has_middles = [](const RawSolid& solid) { return solid.middles.has_value(); };
  return std::all_of(raw.solids.begin(), raw.solids.end(), is_hexahedron) &&
         std::any_of(raw.solids.begin(), raw.solids.end(), has_middles);
}

// Reports volume elements whose omission would leave holes in the body.
bool CheckSolids(const RawMesh& raw, Solids wanted, Problems& problems) {
  const std::size_t before = problems.count();
  if (!raw.solids.empty() && wanted == Solids::kKeep && !raw.tetrahedra.empty()) {
    problems.Add("",
                 "the file has " + CountSolids(raw.solids) + " and " + std::to_string(raw.tetrahedra.size()) +
                     " tetrahedra; a mesh must have tetrahedra only, or none",
                 "`fascicle mesh FILE --convert --split-hexahedra --out FILE.msh` splits them into tetrahedra");
  }
  const std::size_t lost = raw.higher_order + raw.other_solids;
  if (lost > 0 && (!raw.tetrahedra.empty() || !raw.solids.empty())) {
    problems.Add("", std::to_string(lost) + " volume elements of the file are of kinds that are not supported",
                 "write the mesh with tetrahedra of four or ten nodes only");
  }
  return problems.count() == before;
}

// Replaces solids by tetrahedra and quadrilaterals by triangles. Returns the number of tetrahedra before those of each
// solid, and of all.
std::vector<std::size_t> SplitSolids(RawMesh& raw, Solids wanted, const std::stop_token& stop) {
  std::vector<std::size_t> first = {raw.tetrahedra.size()};
  for (std::size_t s = 0; s < raw.solids.size(); ++s) {
    ThrowIfStopped(stop);
    const RawSolid& solid = raw.solids[s];
    SplitSolid(solid.shape, std::span(solid.nodes.data(), static_cast<std::size_t>(CornersOf(solid.shape))),
               raw.tetrahedra);
    first.push_back(raw.tetrahedra.size());
    raw.tetrahedron_tags.resize(raw.tetrahedra.size(), raw.solid_tags[s]);
  }
  for (const auto& [solid, tag] : raw.further_solid_tags) {
    for (std::size_t t = first[static_cast<std::size_t>(solid)]; t < first[static_cast<std::size_t>(solid) + 1]; ++t) {
      raw.further_tags.push_back({static_cast<std::int64_t>(t), tag});
    }
  }
  // Without solids, quadrilaterals are not sides of volume elements.
  for (std::size_t q = 0; !raw.solids.empty() && q < raw.quads.size(); ++q) {
    for (const auto& triangle : SplitQuad(raw.quads[q])) raw.triangles.push_back(triangle);
    raw.triangle_tags.resize(raw.triangles.size(), raw.quad_tags[q]);
  }
  if (!raw.solids.empty() && wanted == Solids::kSplit)
    raw.notes.push_back(CountSolids(raw.solids) + " were split into tetrahedra");
  const bool keeps_middles = wanted == Solids::kKeep && HasMiddles(raw);
  if (keeps_middles && raw.inner_nodes > 0) {
    raw.notes.push_back("the " + std::to_string(raw.inner_nodes) +
                        " nodes in the middle of sides and inside of hexahedra are placed between their edges");
  }
  if (raw.curved_solids > 0 && !keeps_middles) {
    raw.notes.push_back("the mid-edge nodes of " + std::to_string(raw.curved_solids) +
                        (wanted == Solids::kSplit ? " of them" : " hexahedra") +
                        " were left out: their edges are straight");
  }
  return first;
}

// Programs differ in whether the base of a wedge is seen from inside or from outside.
void OrientSolids(const std::vector<std::size_t>& first, std::vector<std::array<std::int32_t, 12>>& middles,
                  TetMesh& mesh) {
  for (std::size_t s = 0; s + 1 < first.size(); ++s) {
    double volume = 0;
    for (std::size_t t = first[s]; t < first[s + 1]; ++t) volume += SignedVolume(mesh, t);
    for (std::size_t t = first[s]; volume < 0 && t < first[s + 1]; ++t) {
      std::swap(mesh.tetrahedra[t][2], mesh.tetrahedra[t][3]);
    }
    if (volume >= 0 || mesh.hexahedra.empty()) continue;
    TurnOver(mesh.hexahedra[s]);
    if (!middles.empty()) std::swap_ranges(middles[s].begin(), middles[s].begin() + 4, middles[s].begin() + 4);
  }
}

// Leaves out nodes without a tetrahedron, and triangles and single nodes on them.
void DropUnused(RawMesh& raw, std::vector<std::array<std::int32_t, 6>>& middles,
                std::vector<std::array<std::int32_t, 12>>& of_hexahedra, TetMesh& mesh) {
  constexpr std::size_t kMostNamed = 5;
  std::vector<std::int32_t> number(mesh.nodes.size(), -1);
  const auto use = [&](const auto& cells) {
    for (const auto& cell : cells) {
      for (const std::int32_t n : cell) number[n] = 0;
    }
  };
  use(mesh.tetrahedra);
  use(middles);
  use(of_hexahedra);
  const auto unused = static_cast<std::size_t>(std::count(number.begin(), number.end(), -1));
  if (unused == 0) return;
  std::string examples;
  std::size_t told = 0;
  std::int32_t count = 0;
  for (std::size_t n = 0; n < number.size(); ++n) {
    if (number[n] == 0) {
      mesh.nodes[count] = mesh.nodes[n];
      number[n] = count++;
    } else if (told++ < kMostNamed) {
      const std::int64_t name =
          raw.node_numbers.empty() ? raw.first_node + static_cast<std::int64_t>(n) : raw.node_numbers[n];
      examples += (told > 1 ? ", " : "") + std::to_string(name);
    }
  }
  mesh.nodes.resize(count);
  const auto renumber = [&](auto& cells) {
    for (auto& cell : cells) {
      for (std::int32_t& n : cell) n = number[n];
    }
  };
  renumber(mesh.tetrahedra);
  renumber(mesh.hexahedra);
  renumber(middles);
  renumber(of_hexahedra);
  renumber(mesh.tagged_triangles);
  const auto is_gone = [](const Triangle& t) { return *std::min_element(t.begin(), t.end()) < 0; };
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.tagged_triangles.size(); ++t) {
    if (is_gone(mesh.tagged_triangles[t])) continue;
    mesh.tagged_triangles[kept] = mesh.tagged_triangles[t];
    mesh.triangle_tags[kept++] = mesh.triangle_tags[t];
  }
  const std::size_t triangles = mesh.tagged_triangles.size() - kept;
  mesh.tagged_triangles.resize(kept);
  mesh.triangle_tags.resize(kept);
  kept = 0;
  for (std::size_t p = 0; p < mesh.tagged_nodes.size(); ++p) {
    if (number[mesh.tagged_nodes[p]] < 0) continue;
    mesh.tagged_nodes[kept] = number[mesh.tagged_nodes[p]];
    mesh.node_tags[kept++] = mesh.node_tags[p];
  }
  mesh.tagged_nodes.resize(kept);
  mesh.node_tags.resize(kept);
  raw.notes.push_back((unused == 1 ? "1 node belongs to no tetrahedron and is left out: "
                                   : std::to_string(unused) + " nodes belong to no tetrahedron and are left out: ") +
                      examples + (unused > kMostNamed ? ", ..." : "") +
                      (triangles > 0 ? "; so are " + std::to_string(triangles) + " triangles on them" : ""));
}

// Turns mid-edge nodes into curved edges, or drops them where the edge is straight up to round-off, and renumbers the
// remaining nodes.
// `cells`: the elements of the mesh, with their nodes in `middles`, one for each of `edges`.
template <class Cell, std::size_t kEdges, class Edges>
void TakeMiddles(const std::vector<Cell>& cells, const Edges& edges_of_cell,
                 const std::vector<std::array<std::int32_t, kEdges>>& middles, const std::string& kind,
                 const std::stop_token& stop, TetMesh& mesh, std::vector<std::array<std::int32_t, 2>>& node_places,
                 Problems& problems) {
  constexpr double kStraight = 1e-9;
  std::vector<char> is_middle(mesh.nodes.size());
  std::map<std::array<std::int32_t, 2>, std::int32_t> edges;
  std::size_t torn = 0;
  for (std::size_t t = 0; t < middles.size(); ++t) {
    ThrowIfStopped(stop);
    for (std::size_t k = 0; k < kEdges; ++k) {
      const auto [i, j] = std::minmax(cells[t][static_cast<std::size_t>(edges_of_cell[k][0])],
                                      cells[t][static_cast<std::size_t>(edges_of_cell[k][1])]);
      is_middle[middles[t][k]] = 1;
      if (edges.try_emplace({i, j}, middles[t][k]).first->second != middles[t][k]) ++torn;
    }
  }
  if (torn > 0) {
    problems.Add("", std::to_string(torn) + " edges have different mid-edge nodes in neighbouring " + kind,
                 "the body would be disconnected there: mesh it again");
    return;
  }
  for (std::size_t t = 0; t < middles.size(); ++t) {
    for (const std::int32_t corner : cells[t]) {
      if (!is_middle[corner]) continue;
      problems.Add("",
                   "node " + std::to_string(corner) +
                       " (counted from 0) is a corner of one and a mid-edge node of another of the " + kind,
                   "mesh the body again, with one element order");
      return;
    }
  }
  for (const auto& [ends, middle] : edges) {
    const Vec3 &a = mesh.nodes[ends[0]], &b = mesh.nodes[ends[1]], &m = mesh.nodes[middle];
    if (!((m - 0.5 * (a + b)).norm() <= kStraight * (b - a).norm())) mesh.curved_edges.push_back({ends, m});
  }
  std::vector<std::int32_t> number(mesh.nodes.size(), -1);
  std::int32_t count = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (is_middle[n]) continue;
    mesh.nodes[count] = mesh.nodes[n];
    number[n] = count++;
  }
  mesh.nodes.resize(count);
  for (const std::int32_t n : number) node_places.push_back({n, n});
  for (const auto& [ends, middle] : edges) node_places[middle] = {number[ends[0]], number[ends[1]]};
  const auto renumber = [&](auto& renumbered) {
    for (auto& cell : renumbered) {
      for (std::int32_t& n : cell) n = number[n];
    }
  };
  renumber(mesh.tetrahedra);
  renumber(mesh.hexahedra);
  for (CurvedEdge& edge : mesh.curved_edges) {
    for (std::int32_t& n : edge.ends) n = number[n];
  }
  // A triangle on mid-edge nodes is not a face of a tetrahedron.
  for (const Triangle& triangle : mesh.tagged_triangles) {
    if (std::none_of(triangle.begin(), triangle.end(), [&](std::int32_t n) { return number[n] < 0; })) continue;
    problems.Add("", "a triangle has a node in the middle of an element's edge", "write both with one element order");
    return;
  }
  renumber(mesh.tagged_triangles);
  // A mid-edge node belongs to a part of the mesh when both ends of its edge do.
  std::size_t kept = 0;
  for (std::size_t p = 0; p < mesh.tagged_nodes.size(); ++p) {
    const std::int32_t node = number[mesh.tagged_nodes[p]];
    if (node < 0) continue;
    mesh.tagged_nodes[kept] = node;
    mesh.node_tags[kept++] = mesh.node_tags[p];
  }
  mesh.tagged_nodes.resize(kept);
  mesh.node_tags.resize(kept);
}

std::optional<TetMesh> MakeMesh(RawMesh& raw, Solids wanted, const std::stop_token& stop, Problems& problems) {
  if (raw.tetrahedra.empty() && raw.solids.empty()) {
    ReportNothingToRead(raw, problems);
    return std::nullopt;
  }
  if (!CheckSolids(raw, wanted, problems)) return std::nullopt;
  const std::vector<std::size_t> split = SplitSolids(raw, wanted, stop);
  if (std::int64_t(raw.nodes.size()) > kMaxIndex || std::int64_t(raw.tetrahedra.size()) > kMaxIndex) {
    problems.Add("", "the mesh has more than 2^31 nodes or tetrahedra", "use a coarser mesh");
    return std::nullopt;
  }
  const std::size_t before = problems.count();
  TetMesh mesh;
  if (!SortNodes(raw, stop, problems)) return std::nullopt;
  const NodeFinder finder(raw);
  FindNodes(finder, raw.tetrahedra, mesh.tetrahedra, "tetrahedra", stop, problems);
  std::vector<std::array<std::int32_t, 12>> middles_of_hexahedra;
  if (wanted == Solids::kKeep && !raw.solids.empty()) {
    std::vector<std::array<std::int64_t, 8>> hexahedra;
    std::vector<std::array<std::int64_t, 12>> higher;
    const bool has_middles = HasMiddles(raw);
    for (const RawSolid& solid : raw.solids) {
      hexahedra.push_back(AsHexahedron(solid.shape, solid.nodes));
      if (solid.middles && has_middles) higher.push_back(*solid.middles);
    }
    FindNodes(finder, hexahedra, mesh.hexahedra, "hexahedra", stop, problems);
    if (!higher.empty() && higher.size() != hexahedra.size()) {
      problems.Add("", "the file mixes hexahedra with and without mid-edge nodes",
                   "write the mesh with one element order");
    } else {
      FindNodes(finder, higher, middles_of_hexahedra, "hexahedra", stop, problems);
    }
  }
  FindNodes(finder, raw.triangles, mesh.tagged_triangles, "triangles", stop, problems);
  mesh.tetrahedron_tags = NarrowTags(raw.tetrahedron_tags, problems);
  mesh.triangle_tags = NarrowTags(raw.triangle_tags, problems);
  if (mesh.triangle_tags.empty()) mesh.tagged_triangles.clear();
  std::vector<std::array<std::int32_t, 1>> points;
  FindNodes(finder, raw.points, points, "points", stop, problems);
  mesh.node_tags = NarrowTags(raw.point_tags, problems);
  if (!mesh.node_tags.empty()) {
    for (const auto& [node] : points) mesh.tagged_nodes.push_back(node);
  }
  std::vector<std::int64_t> further;
  for (const auto& [tetrahedron, tag] : raw.further_tags) further.push_back(tag);
  const std::vector<std::int32_t> further_tags = NarrowTags(further, problems);
  for (std::size_t i = 0; i < further_tags.size(); ++i) {
    mesh.further_tags.push_back({static_cast<std::int32_t>(raw.further_tags[i][0]), further_tags[i]});
  }
  std::vector<std::array<std::int32_t, 6>> middles;
  if (!raw.middles.empty() && raw.middles.size() != raw.tetrahedra.size()) {
    problems.Add("", "the file mixes tetrahedra of four and of ten nodes", "write the mesh with one element order");
  } else {
    FindNodes(finder, raw.middles, middles, "tetrahedra", stop, problems);
  }
  if (problems.count() > before) return std::nullopt;
  mesh.nodes = std::move(raw.nodes);
  OrientSolids(split, middles_of_hexahedra, mesh);
  DropUnused(raw, middles, middles_of_hexahedra, mesh);
  if (!middles.empty()) {
    TakeMiddles(mesh.tetrahedra, kTetEdges, middles, "tetrahedra", stop, mesh, raw.node_places, problems);
  }
  if (!middles_of_hexahedra.empty()) {
    TakeMiddles(mesh.hexahedra, kHexEdges, middles_of_hexahedra, "hexahedra", stop, mesh, raw.node_places, problems);
  }
  if (problems.count() > before) return std::nullopt;
  return mesh;
}

}  // namespace

std::optional<TetMesh> FinishMesh(RawMesh raw, Solids solids, Problems& problems, const std::stop_token& stop,
                                  MeshRemarks* remarks) {
  std::optional<TetMesh> mesh = MakeMesh(raw, solids, stop, problems);
  if (remarks != nullptr) *remarks = {std::move(raw.names), std::move(raw.notes), std::move(raw.node_places)};
  return mesh;
}

std::string KnownMeshExtensions() { return ".msh, .vtu, .vtk, .mesh, .node, .inp"; }

std::optional<TetMesh> ReadMesh(const MeshFile& file, Problems& problems, const std::stop_token& stop,
                                MeshRemarks* remarks) {
  const std::string_view text = WithoutByteOrderMark(file.bytes);
  const std::string extension = LowerExtension(file.name);
  const std::size_t before = problems.count();
  RawMesh raw;
  if (extension == ".msh") {
    raw = ReadGmsh(text, stop, problems);
  } else if (extension == ".vtu") {
    raw = ReadVtu(text, stop, problems);
  } else if (extension == ".vtk") {
    raw = ReadVtkLegacy(text, stop, problems);
  } else if (extension == ".mesh") {
    raw = ReadMedit(text, stop, problems);
  } else if (extension == ".node") {
    raw = ReadTetgen(text, WithoutByteOrderMark(file.element_bytes), stop, problems);
  } else if (extension == ".inp") {
    raw = ReadAbaqus(text, stop, problems);
  } else {
    const bool surface = extension == ".stl" || extension == ".obj" || extension == ".ply" || extension == ".off";
    problems.Add("", "the file extension " + Quoted(extension) + " is not that of a mesh that can be read",
                 extension == ".ele" ? "give the .node file as the mesh and this one as its elements"
                 : extension == ".xdmf" || extension == ".xmf" ? "write it as .vtu, for example with ParaView"
                 : extension == ".feb" || extension == ".e" || extension == ".exo"
                     ? "`fascicle mesh FILE --convert --out FILE.msh` converts it"
                 : surface ? "a surface is not enough: fill it with tetrahedra; known are " + KnownMeshExtensions()
                           : "known are " + KnownMeshExtensions());
  }
  if (problems.count() > before) return std::nullopt;
  return FinishMesh(std::move(raw), file.solids, problems, stop, remarks);
}

}  // namespace fascicle
