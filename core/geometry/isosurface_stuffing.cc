// Reference: Labelle and Shewchuk 2007, "Isosurface Stuffing: Fast Tetrahedral Meshes with Good Dihedral Angles", ACM
// TOG 26(3).
#include "core/geometry/isosurface_stuffing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/check.h"
#include "core/base/stop.h"
#include "core/geometry/unused_nodes.h"

namespace fascicle {
namespace {

// A node is moved to a cut that is nearer than this fraction of the edge. `Long` edges join two corners or two centres,
// `short` ones a corner and a centre [Labelle and Shewchuk 2007, table 1].
constexpr double kWarpLong = 0.24999, kWarpShort = 0.41189;
// Accuracy of cut points, relative to the lattice's width.
constexpr double kCutAccuracy = 1e-4;

struct Edge {
  std::int32_t inside, outside;
  std::int32_t cut = -1;  // node of the result; -1 once an end has been moved onto the surface
  auto Key() const { return std::pair(inside, outside); }
};

class Stuffing {
 public:
  Stuffing(const Lattice& lattice, const TriangleTree& tree, ThreadTeam& team)
      : lattice_(lattice), tree_(tree), team_(team) {}

  TetMesh Run() {
    Evaluate();
    FindEdges();
    FindCuts();
    Warp();
    for (const Tetrahedron& tetrahedron : kept_) {
      team_.ThrowIfStopped();
      Fill(tetrahedron);
    }
    DropUnusedNodes(mesh_.nodes, mesh_.tetrahedra);
    return std::move(mesh_);
  }

 private:
  void Evaluate() {
    const std::size_t count = lattice_.positions.size();
    values_.resize(count);
    mesh_.nodes.resize(count);
    ForEach(team_, count, 64, [&](std::size_t n) {
      mesh_.nodes[n] = lattice_.Position(n);
      values_[n] = tree_.SignedDistance(mesh_.nodes[n]);
    });
    for (const Tetrahedron& t : lattice_.tetrahedra) {
      if (std::any_of(t.begin(), t.end(), [&](std::int32_t n) { return values_[n] < 0; })) kept_.push_back(t);
    }
  }

  // Finds the edges with one end inside and one outside.
  void FindEdges() {
    for (const Tetrahedron& t : kept_) {
      for (const auto& [i, j] : kTetEdges) {
        if (values_[t[i]] < 0 && values_[t[j]] > 0) edges_.push_back({t[i], t[j]});
        if (values_[t[j]] < 0 && values_[t[i]] > 0) edges_.push_back({t[j], t[i]});
      }
    }
    SortUnlessStopped(edges_, team_.stop(), [](const Edge& a, const Edge& b) { return a.Key() < b.Key(); });
    edges_.erase(
        std::unique(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) { return a.Key() == b.Key(); }),
        edges_.end());
  }

  // The Illinois variant of regula falsi: it keeps a bracket and needs no derivative.
  Vec3 CutOf(const Edge& edge) const {
    const Vec3 a = mesh_.nodes[edge.inside], b = mesh_.nodes[edge.outside];
    double low = 0, high = 1, at_low = values_[edge.inside], at_high = values_[edge.outside], s = 0.5;
    constexpr int kMost = 60;
    int last = 0;  // the end that moved last
    for (int i = 0; i < kMost; ++i) {
      // Bisects now and then, for surfaces that fold within the edge.
      s = i % 8 == 7 ? 0.5 * (low + high) : low - at_low * (high - low) / (at_high - at_low);
      const double value = tree_.SignedDistance(a + s * (b - a));
      if (std::abs(value) < kCutAccuracy * lattice_.half || high - low < kCutAccuracy) break;
      if (value < 0) {
        low = s;
        at_low = value;
        if (last == -1) at_high /= 2;
        last = -1;
      } else {
        high = s;
        at_high = value;
        if (last == 1) at_low /= 2;
        last = 1;
      }
    }
    return a + s * (b - a);
  }

  void FindCuts() {
    const std::size_t first = mesh_.nodes.size();
    mesh_.nodes.resize(first + edges_.size());
    ForEach(team_, edges_.size(), 16, [&](std::size_t e) {
      edges_[e].cut = static_cast<std::int32_t>(first + e);
      mesh_.nodes[first + e] = CutOf(edges_[e]);
    });
  }

  // Axis-parallel: between two corners or two centres.
  bool IsLong(const Edge& edge) const { return IsLong(edge.inside, edge.outside); }
  bool IsLong(std::int32_t a, std::int32_t b) const {
    int differences = 0;
    for (int axis = 0; axis < 3; ++axis) differences += lattice_.positions[a][axis] != lattice_.positions[b][axis];
    return differences == 1;
  }

  // Moves each node, in order, to the nearest cut within the threshold. The other cuts of its edges are then void.
  void Warp() {
    std::vector<std::vector<std::int32_t>> edges_of(lattice_.positions.size());
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      edges_of[edges_[e].inside].push_back(static_cast<std::int32_t>(e));
      edges_of[edges_[e].outside].push_back(static_cast<std::int32_t>(e));
    }
    for (std::size_t n = 0; n < edges_of.size(); ++n) {
      team_.ThrowIfStopped();
      double nearest = 0;
      std::int32_t target = -1;
      for (const std::int32_t e : edges_of[n]) {
        const Edge& edge = edges_[e];
        if (edge.cut < 0) continue;
        const double distance = (mesh_.nodes[edge.cut] - lattice_.Position(n)).norm();
        const double length = (lattice_.Position(edge.inside) - lattice_.Position(edge.outside)).norm();
        if (distance >= (IsLong(edge) ? kWarpLong : kWarpShort) * length) continue;
        if (target >= 0 && distance >= nearest) continue;
        nearest = distance;
        target = edge.cut;
      }
      if (target < 0) continue;
      mesh_.nodes[n] = mesh_.nodes[target];
      values_[n] = 0;
      for (const std::int32_t e : edges_of[n]) edges_[e].cut = -1;
    }
  }

  std::int32_t Cut(std::int32_t inside, std::int32_t outside) const {
    const auto at = std::lower_bound(edges_.begin(), edges_.end(), std::pair(inside, outside),
                                     [](const Edge& a, const auto& key) { return a.Key() < key; });
    FASCICLE_CHECK(at != edges_.end() && at->Key() == std::pair(inside, outside) && at->cut >= 0, "a cut is missing");
    return at->cut;
  }

  void Add(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    Tetrahedron t = {a, b, c, d};
    const std::vector<Vec3>& x = mesh_.nodes;
    if ((x[b] - x[a]).cross(x[c] - x[a]).dot(x[d] - x[a]) < 0) std::swap(t[2], t[3]);
    mesh_.tetrahedra.push_back(t);
  }

  // How to split the quadrilateral of inside nodes a and b and their cuts towards `o`: true if the diagonal ends in the
  // cut of a. It ends in the cut of a long edge. With two short edges their directions decide, so that two such
  // quadrilaterals of a tetrahedron are split crosswise [Labelle and Shewchuk 2007, the parity rule].
  bool EndsInFirst(std::int32_t a, std::int32_t b, std::int32_t o) const {
    if (IsLong(a, o)) return true;
    if (IsLong(b, o)) return false;
    int greater = 0;
    for (int axis = 0; axis < 3; ++axis) greater += lattice_.positions[a][axis] > lattice_.positions[o][axis];
    return greater % 2 == 0;
  }

  // Adds the part of a tetrahedron that lies inside, by the signs at its corners.
  void Fill(const Tetrahedron& tetrahedron) {
    std::array<std::int32_t, 4> in{}, on{}, out{};
    int ins = 0, ons = 0, outs = 0;
    for (const std::int32_t n : tetrahedron) {
      (values_[n] < 0 ? in[ins++] : values_[n] > 0 ? out[outs++] : on[ons++]) = n;
    }
    if (ins == 0) return;
    if (outs == 0) {
      Add(tetrahedron[0], tetrahedron[1], tetrahedron[2], tetrahedron[3]);
    } else if (ins == 1) {
      std::array<std::int32_t, 3> rest{};
      for (int i = 0; i < 3; ++i) rest[i] = i < ons ? on[i] : Cut(in[0], out[i - ons]);
      Add(in[0], rest[0], rest[1], rest[2]);
    } else if (ins == 2 && outs == 1) {
      AddPyramid(on[0], in[0], in[1], out[0]);
    } else if (ins == 2) {
      FillTwoAndTwo(in[0], in[1], out[0], out[1]);
    } else {
      FillThreeAndOne({in[0], in[1], in[2]}, out[0]);
    }
  }

  // Adds the pyramid over the quadrilateral of a, b and their cuts towards o.
  void AddPyramid(std::int32_t apex, std::int32_t a, std::int32_t b, std::int32_t o) {
    if (!EndsInFirst(a, b, o)) std::swap(a, b);
    Add(apex, a, b, Cut(a, o));
    Add(apex, b, Cut(b, o), Cut(a, o));
  }

  void FillTwoAndTwo(std::int32_t a, std::int32_t b, std::int32_t o, std::int32_t p) {
    const bool o_in_a = EndsInFirst(a, b, o), p_in_a = EndsInFirst(a, b, p);
    if (o_in_a == p_in_a) {
      // Both diagonals start at one node: cut off the corner at the other one.
      if (!o_in_a) std::swap(a, b);
      Add(b, a, Cut(a, o), Cut(a, p));
      Add(b, Cut(a, o), Cut(a, p), Cut(b, o));
      Add(b, Cut(a, p), Cut(b, p), Cut(b, o));
      return;
    }
    if (!o_in_a) std::swap(o, p);
    Add(a, b, Cut(a, o), Cut(b, p));
    Add(b, Cut(b, o), Cut(b, p), Cut(a, o));
    Add(a, Cut(a, o), Cut(a, p), Cut(b, p));
  }

  void FillThreeAndOne(std::array<std::int32_t, 3> in, std::int32_t o) {
    // Rotates the cut in which two diagonals end to the first place.
    for (int turn = 0; turn < 3; ++turn) {
      if (EndsInFirst(in[0], in[1], o) && EndsInFirst(in[0], in[2], o)) break;
      std::rotate(in.begin(), in.begin() + 1, in.end());
    }
    FASCICLE_CHECK(EndsInFirst(in[0], in[1], o) && EndsInFirst(in[0], in[2], o), "one of three edges is long");
    const std::int32_t cut = Cut(in[0], o);
    Add(cut, in[0], in[1], in[2]);
    AddPyramid(cut, in[1], in[2], o);
  }

  const Lattice& lattice_;
  const TriangleTree& tree_;
  ThreadTeam& team_;
  std::vector<double> values_;     // signed distances at the lattice's nodes; 0 for nodes moved onto the surface
  std::vector<Tetrahedron> kept_;  // those with a node inside
  std::vector<Edge> edges_;        // ascending
  TetMesh mesh_;
};

}  // namespace

TetMesh StuffLattice(const Lattice& lattice, const TriangleTree& tree, ThreadTeam& team) {
  return Stuffing(lattice, tree, team).Run();
}

}  // namespace fascicle
