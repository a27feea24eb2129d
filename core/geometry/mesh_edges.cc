#include "core/geometry/mesh_edges.h"

#include <algorithm>
#include <utility>

#include "core/base/stop.h"

namespace fascicle {
namespace {

std::array<std::int32_t, 2> SortedEnds(std::int32_t i, std::int32_t j) { return {std::min(i, j), std::max(i, j)}; }

// An edge of a tetrahedron: edge k of tetrahedron t is use 6 t + k.
struct EdgeUse {
  std::array<std::int32_t, 2> ends;
  std::int64_t use;
};

// Sorted by ends; uses of one edge ascending.
std::vector<EdgeUse> SortedUses(const TetMesh& mesh, const std::stop_token& stop) {
  std::vector<EdgeUse> uses;
  uses.reserve(6 * mesh.tetrahedra.size());
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    for (const auto& [a, b] : kTetEdges) {
      uses.push_back({SortedEnds(tet[a], tet[b]), static_cast<std::int64_t>(uses.size())});
    }
  }
  ThrowIfStopped(stop);
  std::sort(uses.begin(), uses.end(),
            [](const EdgeUse& a, const EdgeUse& b) { return std::pair(a.ends, a.use) < std::pair(b.ends, b.use); });
  ThrowIfStopped(stop);
  return uses;
}

}  // namespace

std::int32_t MeshEdges::Between(std::int32_t i, std::int32_t j) const {
  const std::array<std::int32_t, 2> wanted = SortedEnds(i, j);
  const auto place = std::lower_bound(sorted.begin(), sorted.end(), wanted,
                                      [this](std::int32_t edge, const auto& value) { return ends[edge] < value; });
  return place != sorted.end() && ends[*place] == wanted ? *place : -1;
}

MeshEdges NumberEdges(const TetMesh& mesh, const std::stop_token& stop) {
  const std::vector<EdgeUse> uses = SortedUses(mesh, stop);
  // The first use of each edge, in the order of uses, gives its number.
  std::vector<std::int64_t> first_use(uses.size());
  for (std::size_t k = 0; k < uses.size(); ++k) {
    const bool is_new = k == 0 || uses[k].ends != uses[k - 1].ends;
    first_use[uses[k].use] = is_new ? uses[k].use : first_use[uses[k - 1].use];
  }
  MeshEdges edges;
  edges.of_tetrahedra.resize(mesh.tetrahedra.size());
  for (std::size_t use = 0; use < first_use.size(); ++use) {
    const std::size_t t = use / 6, k = use % 6;
    const auto first = static_cast<std::size_t>(first_use[use]);
    std::int32_t number = 0;
    if (first == use) {
      number = static_cast<std::int32_t>(edges.ends.size());
      edges.ends.push_back(SortedEnds(mesh.tetrahedra[t][kTetEdges[k][0]], mesh.tetrahedra[t][kTetEdges[k][1]]));
    } else {
      number = edges.of_tetrahedra[first / 6][first % 6];
    }
    edges.of_tetrahedra[t][k] = number;
  }
  for (std::size_t k = 0; k < uses.size(); ++k) {
    if (k > 0 && uses[k].ends == uses[k - 1].ends) continue;
    const auto first = static_cast<std::size_t>(uses[k].use);
    edges.sorted.push_back(edges.of_tetrahedra[first / 6][first % 6]);
  }
  return edges;
}

std::vector<Vec3> EdgeMiddles(const TetMesh& mesh, const MeshEdges& edges) {
  std::vector<Vec3> middles;
  middles.reserve(edges.ends.size());
  for (const auto& [i, j] : edges.ends) middles.emplace_back(0.5 * (mesh.nodes[i] + mesh.nodes[j]));
  for (const CurvedEdge& edge : mesh.curved_edges) {
    const std::int32_t number = edges.Between(edge.ends[0], edge.ends[1]);
    if (number >= 0) middles[number] = edge.middle;
  }
  return middles;
}

std::vector<bool> EdgesWithin(const TetMesh& mesh, const MeshEdges& edges, const std::vector<Triangle>& boundary,
                              const std::vector<std::int32_t>& nodes) {
  std::vector<bool> inside(mesh.nodes.size(), false);
  for (const std::int32_t n : nodes) inside[n] = true;
  std::vector<bool> within(edges.ends.size(), false);
  for (const Triangle& t : boundary) {
    for (int c = 0; c < 3; ++c) {
      const std::int32_t i = t[c], j = t[(c + 1) % 3];
      if (inside[i] && inside[j]) within[edges.Between(i, j)] = true;
    }
  }
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const Tetrahedron& tet = mesh.tetrahedra[t];
    if (!std::all_of(tet.begin(), tet.end(), [&](std::int32_t n) { return inside[n]; })) continue;
    for (const std::int32_t edge : edges.of_tetrahedra[t]) within[edge] = true;
  }
  return within;
}

}  // namespace fascicle
