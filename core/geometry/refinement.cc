#include "core/geometry/refinement.h"

#include <algorithm>
#include <map>
#include <unordered_map>

#include "core/base/stop.h"

namespace fascicle {
namespace {

using EdgeEnds = std::array<std::int32_t, 2>;  // node indices, ascending

EdgeEnds EdgeBetween(std::int32_t i, std::int32_t j) { return {std::min(i, j), std::max(i, j)}; }

// Refines one mesh. The nodes of a tetrahedron are numbered as those of a quadratic element: four corners, then the
// middles of kTetEdges.
class TetrahedraRefiner {
 public:
  TetrahedraRefiner(const TetMesh& coarse, const std::stop_token& stop) : coarse_(coarse), stop_(stop) {
    for (const CurvedEdge& edge : coarse.curved_edges) {
      curved_.emplace(EdgeBetween(edge.ends[0], edge.ends[1]), edge.middle);
    }
  }

  RefinedTetrahedra Refine() && {
    result_.mesh.nodes = coarse_.nodes;
    result_.mesh.tetrahedra.reserve(kChildren * coarse_.tetrahedra.size());
    for (const Tetrahedron& tet : coarse_.tetrahedra) {
      ThrowIfStopped(stop_);
      Divide(tet);
    }
    for (const Triangle& triangle : coarse_.tagged_triangles) Divide(triangle);
    CopyTags();
    for (const auto& [edge, middle] : halves_) result_.mesh.curved_edges.push_back({edge, middle});
    return std::move(result_);
  }

 private:
  using Nodes = std::array<std::int32_t, 10>;

  std::int32_t MiddleOf(std::int32_t i, std::int32_t j) {
    const EdgeEnds edge = EdgeBetween(i, j);
    const std::uint64_t key = static_cast<std::uint64_t>(edge[0]) << 32 | static_cast<std::uint32_t>(edge[1]);
    const auto [place, is_new] = middles_.try_emplace(key, static_cast<std::int32_t>(result_.mesh.nodes.size()));
    if (is_new) {
      const auto curved = curved_.find(edge);
      result_.mesh.nodes.push_back(curved != curved_.end() ? curved->second
                                                           : Vec3(0.5 * (coarse_.nodes[i] + coarse_.nodes[j])));
      result_.ends.push_back(edge);
      if (curved != curved_.end()) AddHalves(edge, curved->second, place->second);
    }
    return place->second;
  }

  // The middles of the halves of a parabola.
  void AddHalves(const EdgeEnds& edge, const Vec3& middle, std::int32_t node) {
    const Vec3 &a = coarse_.nodes[edge[0]], &b = coarse_.nodes[edge[1]];
    halves_[EdgeBetween(edge[0], node)] = 0.375 * a + 0.75 * middle - 0.125 * b;
    halves_[EdgeBetween(edge[1], node)] = 0.375 * b + 0.75 * middle - 0.125 * a;
  }

  void Divide(const Tetrahedron& tet) {
    Nodes n;
    std::copy(tet.begin(), tet.end(), n.begin());
    for (int k = 0; k < 6; ++k) n[4 + k] = MiddleOf(tet[kTetEdges[k][0]], tet[kTetEdges[k][1]]);
    // The corners: each with the middles of its three edges.
    AddTetrahedron(n[0], n[4], n[6], n[7]);
    AddTetrahedron(n[4], n[1], n[5], n[8]);
    AddTetrahedron(n[6], n[5], n[2], n[9]);
    AddTetrahedron(n[7], n[8], n[9], n[3]);
    DivideOctahedron(n);
    if (!curved_.empty()) CurveInside(n);
  }

  // The octahedron between the corners: four tetrahedra around a diagonal.
  void DivideOctahedron(const Nodes& n) {
    // The ends of each diagonal, and the other four corners in order around it.
    constexpr int kDiagonals[3][6] = {{4, 9, 5, 6, 7, 8}, {5, 7, 9, 6, 4, 8}, {6, 8, 4, 5, 9, 7}};
    const int* shortest = kDiagonals[0];
    for (const auto& diagonal : kDiagonals) {
      if (Length(n, diagonal) < (1 - 1e-9) * Length(n, shortest)) shortest = diagonal;
    }
    for (int k = 0; k < 4; ++k) {
      AddTetrahedron(n[shortest[0]], n[shortest[1]], n[shortest[2 + k]], n[shortest[2 + (k + 1) % 4]]);
    }
    diagonal_ = EdgeBetween(n[shortest[0]], n[shortest[1]]);
  }
  double Length(const Nodes& n, const int* diagonal) const {
    return (result_.mesh.nodes[n[diagonal[0]]] - result_.mesh.nodes[n[diagonal[1]]]).norm();
  }

  // In either order of its nodes.
  void AddTetrahedron(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    std::vector<Tetrahedron>& tetrahedra = result_.mesh.tetrahedra;
    tetrahedra.push_back({a, b, c, d});
    if (SignedVolume(result_.mesh, tetrahedra.size() - 1) < 0) std::swap(tetrahedra.back()[2], tetrahedra.back()[3]);
  }

  bool IsCurved(std::int32_t i, std::int32_t j) const { return curved_.contains(EdgeBetween(i, j)); }

  // Edges inside of a curved element's faces, and the diagonal, follow the element's quadratic map.
  void CurveInside(const Nodes& n) {
    const std::vector<Vec3>& X = result_.mesh.nodes;
    constexpr int kFaces[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
    bool any = false;
    for (const auto& face : kFaces) {
      for (int c = 0; c < 3; ++c) {
        const std::int32_t a = n[face[c]], b = n[face[(c + 1) % 3]], d = n[face[(c + 2) % 3]];
        if (!IsCurved(a, b) && !IsCurved(b, d) && !IsCurved(d, a)) continue;
        any = true;
        const std::int32_t ab = MiddleOf(a, b), ad = MiddleOf(a, d), bd = MiddleOf(b, d);
        halves_[EdgeBetween(ab, ad)] = -0.125 * (X[b] + X[d]) + 0.5 * (X[ab] + X[ad]) + 0.25 * X[bd];
      }
    }
    if (!any) return;
    Vec3 middle = Vec3::Zero();
    for (int c = 0; c < 4; ++c) middle -= 0.125 * X[n[c]];
    for (int k = 4; k < 10; ++k) middle += 0.25 * X[n[k]];
    halves_[diagonal_] = middle;
  }

  void Divide(const Triangle& t) {
    const Triangle middle = {MiddleOf(t[0], t[1]), MiddleOf(t[1], t[2]), MiddleOf(t[2], t[0])};
    std::vector<Triangle>& triangles = result_.mesh.tagged_triangles;
    triangles.push_back({t[0], middle[0], middle[2]});
    triangles.push_back({middle[0], t[1], middle[1]});
    triangles.push_back({middle[2], middle[1], t[2]});
    triangles.push_back(middle);
  }

  void CopyTags() {
    TetMesh& fine = result_.mesh;
    for (const std::int32_t tag : coarse_.tetrahedron_tags) {
      fine.tetrahedron_tags.insert(fine.tetrahedron_tags.end(), kChildren, tag);
    }
    for (const auto& [tet, tag] : coarse_.further_tags) {
      for (int k = 0; k < static_cast<int>(kChildren); ++k) {
        fine.further_tags.push_back({static_cast<std::int32_t>(kChildren) * tet + k, tag});
      }
    }
    for (const std::int32_t tag : coarse_.triangle_tags) fine.triangle_tags.insert(fine.triangle_tags.end(), 4, tag);
    CopyNodeTags();
  }

  void CopyNodeTags() {
    TetMesh& fine = result_.mesh;
    fine.tagged_nodes = coarse_.tagged_nodes;
    fine.node_tags = coarse_.node_tags;
    std::map<std::int32_t, std::vector<std::int32_t>> tags;  // of each tagged node
    for (std::size_t i = 0; i < coarse_.tagged_nodes.size(); ++i) {
      tags[coarse_.tagged_nodes[i]].push_back(coarse_.node_tags[i]);
    }
    if (tags.empty()) return;
    for (std::size_t i = 0; i < result_.ends.size(); ++i) {
      const auto first = tags.find(result_.ends[i][0]), second = tags.find(result_.ends[i][1]);
      if (first == tags.end() || second == tags.end()) continue;
      for (const std::int32_t tag : first->second) {
        if (std::find(second->second.begin(), second->second.end(), tag) == second->second.end()) continue;
        fine.tagged_nodes.push_back(static_cast<std::int32_t>(coarse_.nodes.size() + i));
        fine.node_tags.push_back(tag);
      }
    }
  }

  const TetMesh& coarse_;
  const std::stop_token& stop_;
  std::map<EdgeEnds, Vec3> curved_;  // the middle of each curved edge of the coarse mesh
  std::map<EdgeEnds, Vec3> halves_;  // and of each of the fine one
  std::unordered_map<std::uint64_t, std::int32_t> middles_;
  EdgeEnds diagonal_ = {};
  RefinedTetrahedra result_;
};

}  // namespace

RefinedTetrahedra Refined(const TetMesh& mesh, const std::stop_token& stop) {
  return TetrahedraRefiner(mesh, stop).Refine();
}

VoxelGrid Refined(const VoxelGrid& grid, const std::stop_token& stop) {
  VoxelGrid fine = MakeVoxelGrid({2 * grid.size[0], 2 * grid.size[1], 2 * grid.size[2]}, grid.spacing / 2);
  fine.origin = grid.origin;
  fine.direction = grid.direction;
  if (!grid.stiffness.empty()) fine.stiffness.resize(fine.voxels());
  ForVoxels(
      fine,
      [&](std::size_t v, const GridIndex& at) {
        const std::size_t parent = grid.IndexOf({at[0] / 2, at[1] / 2, at[2] / 2});
        fine.material[v] = grid.material[parent];
        if (!grid.stiffness.empty()) fine.stiffness[v] = grid.stiffness[parent];
      },
      stop);
  return fine;
}

}  // namespace fascicle
