// Reference: Freitag and Ollivier-Gooch 1997, "Tetrahedral mesh improvement using swapping and smoothing", IJNME 40.
#include "core/geometry/mesh_improvement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/stop.h"
#include "core/geometry/mesh_quality.h"

namespace fascicle {
namespace {

// Nodes are left alone when all dihedral angles around them are at least this far from 0 and 180 degrees.
const double kGoodCosine = std::cos(35 * std::numbers::pi / 180);
// Fitting the surface must not make an angle smaller than this.
const double kFitCosine = std::cos(15 * std::numbers::pi / 180);
constexpr int kFitRounds = 4;

// For each node, the ascending numbers of the cells that contain it.
class CellsOfNodes {
 public:
  template <class Cells>
  CellsOfNodes(std::size_t nodes, const Cells& cells) : begin_(nodes + 1) {
    for (const auto& cell : cells) {
      for (const std::int32_t n : cell) ++begin_[n + 1];
    }
    for (std::size_t n = 0; n < nodes; ++n) begin_[n + 1] += begin_[n];
    cells_.resize(begin_[nodes]);
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t c = 0; c < cells.size(); ++c) {
      for (const std::int32_t n : cells[c]) cells_[next[n]++] = static_cast<std::int32_t>(c);
    }
  }
  const std::int32_t* begin(std::size_t n) const { return cells_.data() + begin_[n]; }
  const std::int32_t* end(std::size_t n) const { return cells_.data() + begin_[n + 1]; }

 private:
  std::vector<std::size_t> begin_;
  std::vector<std::int32_t> cells_;
};

// Colours the nodes so that nodes of one colour share no tetrahedron and may move at the same time: each node gets the
// lowest colour that no neighbour has.
std::vector<std::vector<std::int32_t>> Colours(const TetMesh& mesh, const CellsOfNodes& tetrahedra,
                                               const std::stop_token& stop) {
  std::vector<std::int32_t> colour(mesh.nodes.size(), -1);
  std::vector<std::vector<std::int32_t>> nodes_of;
  std::vector<char> taken;
  for (std::size_t n = 0; n < colour.size(); ++n) {
    ThrowIfStopped(stop);
    taken.assign(nodes_of.size() + 1, 0);
    for (const std::int32_t* t = tetrahedra.begin(n); t != tetrahedra.end(n); ++t) {
      for (const std::int32_t m : mesh.tetrahedra[*t]) {
        if (colour[m] >= 0) taken[colour[m]] = 1;
      }
    }
    colour[n] = static_cast<std::int32_t>(std::find(taken.begin(), taken.end(), 0) - taken.begin());
    if (colour[n] == static_cast<std::int32_t>(nodes_of.size())) nodes_of.emplace_back();
    nodes_of[colour[n]].push_back(static_cast<std::int32_t>(n));
  }
  return nodes_of;
}

class Improvement {
 public:
  Improvement(TetMesh& mesh, const TriangleTree& tree, ThreadTeam& team)
      : mesh_(mesh),
        tree_(tree),
        team_(team),
        surface_(BoundaryTriangles(mesh, team.stop())),
        tetrahedra_of_(mesh.nodes.size(), mesh.tetrahedra),
        triangles_of_(mesh.nodes.size(), surface_),
        colours_(Colours(mesh, tetrahedra_of_, team.stop())) {}

  void ImproveAngles(int sweeps) {
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      ForEachNode([&](std::size_t n) { ImproveNode(n); });
    }
  }

  void FitSurface(std::optional<double> volume) {
    for (int round = 0; round < kFitRounds; ++round) {
      const std::vector<double> offsets = MeanOffsets();
      MoveOuterNodes([&](std::size_t n) { return offsets[n]; });
    }
    for (int round = 0; round < kFitRounds && volume; ++round) {
      double area = 0;
      for (const Triangle& triangle : surface_) area += AreaVector(triangle).norm();
      const double offset = (*volume - TotalVolume(mesh_)) / area;
      MoveOuterNodes([&](std::size_t) { return offset; });
    }
  }

 private:
  // Visits nodes of one colour in parallel, colour after colour.
  template <class Visit>
  void ForEachNode(const Visit& visit) {
    for (const std::vector<std::int32_t>& nodes : colours_) {
      ForEach(team_, nodes.size(), 32, [&](std::size_t i) { visit(static_cast<std::size_t>(nodes[i])); });
    }
  }

  bool IsOuter(std::size_t n) const { return triangles_of_.begin(n) != triangles_of_.end(n); }

  // Largest |cosine| of the dihedral angles around node n if it were at `x`: larger is worse, and over 1 means
  // inverted. Returns early once the result is no better than `limit`.
  double Badness(std::size_t n, const Vec3& x, double limit = 3) const {
    double worst = 0;
    for (const std::int32_t* t = tetrahedra_of_.begin(n); t != tetrahedra_of_.end(n) && worst < limit; ++t) {
      std::array<Vec3, 4> corners;
      for (int i = 0; i < 4; ++i) {
        const std::int32_t m = mesh_.tetrahedra[*t][i];
        corners[i] = static_cast<std::size_t>(m) == n ? x : mesh_.nodes[m];
      }
      const Cosines cosines = DihedralCosines(corners[0], corners[1], corners[2], corners[3]);
      worst = std::max({worst, cosines.highest, -cosines.lowest});
    }
    return worst;
  }

  // Mean of the nodes of the adjacent cells.
  template <class Cells>
  Vec3 Middle(std::size_t n, const CellsOfNodes& cells_of, const Cells& cells) const {
    Vec3 sum = Vec3::Zero();
    double count = 0;
    for (const std::int32_t* c = cells_of.begin(n); c != cells_of.end(n); ++c) {
      for (const std::int32_t m : cells[*c]) {
        if (static_cast<std::size_t>(m) == n) continue;
        sum += mesh_.nodes[m];
        ++count;
      }
    }
    return sum / count;
  }

  void ImproveNode(std::size_t n) {
    Vec3& x = mesh_.nodes[n];
    double best = Badness(n, x);
    if (best <= kGoodCosine) return;
    const bool outer = IsOuter(n);
    const Vec3 middle = outer ? Middle(n, triangles_of_, surface_) : Middle(n, tetrahedra_of_, mesh_.tetrahedra);
    const auto attempt = [&](const Vec3& wanted) {
      const Vec3 candidate = outer ? tree_.FindNearest(wanted).point : wanted;
      const double badness = Badness(n, candidate, best);
      if (badness >= best) return false;
      best = badness;
      x = candidate;
      return true;
    };
    const Vec3 start = x;
    for (double part = 1; part > 0.2; part /= 2) {
      if (attempt(start + part * (middle - start))) break;
    }
    double step = 0.15 * (Middle(n, tetrahedra_of_, mesh_.tetrahedra) - mesh_.nodes[Neighbour(n)]).norm();
    for (int round = 0; round < 3; ++round, step /= 2) Search(n, step, attempt);
  }

  std::size_t Neighbour(std::size_t n) const {
    const Tetrahedron& t = mesh_.tetrahedra[*tetrahedra_of_.begin(n)];
    return static_cast<std::size_t>(static_cast<std::size_t>(t[0]) == n ? t[1] : t[0]);
  }

  // Tries steps along the axes and diagonals.
  template <class Attempt>
  void Search(std::size_t n, double step, const Attempt& attempt) const {
    for (int direction = 0; direction < 27; ++direction) {
      const Vec3 d(direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1);
      if (d.isZero(0)) continue;
      attempt(mesh_.nodes[n] + step * d.normalized());
    }
  }

  Vec3 AreaVector(const Triangle& t) const {
    return (mesh_.nodes[t[1]] - mesh_.nodes[t[0]]).cross(mesh_.nodes[t[2]] - mesh_.nodes[t[0]]) / 2;
  }

  // Mean distance of the surface beyond each triangle, by a quadrature rule of degree 2 with interior points; then for
  // each node the mean over its triangles.
  std::vector<double> MeanOffsets() const {
    std::vector<double> offset(surface_.size());
    ForEach(team_, surface_.size(), 32, [&](std::size_t i) {
      const auto& [a, b, c] = surface_[i];
      const Vec3 sum = mesh_.nodes[a] + mesh_.nodes[b] + mesh_.nodes[c];
      for (const std::int32_t corner : surface_[i]) {
        offset[i] -= tree_.SignedDistance(sum / 6 + mesh_.nodes[corner] / 2) / 3;
      }
    });
    std::vector<double> mean(mesh_.nodes.size());
    for (std::size_t n = 0; n < mean.size(); ++n) {
      double area = 0;
      for (const std::int32_t* t = triangles_of_.begin(n); t != triangles_of_.end(n); ++t) {
        const double own = AreaVector(surface_[*t]).norm();
        mean[n] += own * offset[*t];
        area += own;
      }
      if (area > 0) mean[n] /= area;
    }
    return mean;
  }

  template <class Offset>
  void MoveOuterNodes(const Offset& offset) {
    ForEachNode([&](std::size_t n) {
      if (!IsOuter(n)) return;
      Vec3 normal = Vec3::Zero();
      for (const std::int32_t* t = triangles_of_.begin(n); t != triangles_of_.end(n); ++t) {
        normal += AreaVector(surface_[*t]);
      }
      if (!(normal.norm() > 0)) return;
      const Vec3 moved = mesh_.nodes[n] + offset(n) * normal.normalized();
      const double before = Badness(n, mesh_.nodes[n]);
      if (Badness(n, moved) <= std::max(before, kFitCosine)) mesh_.nodes[n] = moved;
    });
  }

  TetMesh& mesh_;
  const TriangleTree& tree_;
  ThreadTeam& team_;
  std::vector<Triangle> surface_;
  CellsOfNodes tetrahedra_of_, triangles_of_;
  std::vector<std::vector<std::int32_t>> colours_;
};

}  // namespace

void ImproveAngles(TetMesh& mesh, const TriangleTree& tree, int sweeps, ThreadTeam& team) {
  Improvement(mesh, tree, team).ImproveAngles(sweeps);
}

void FitSurface(TetMesh& mesh, const TriangleTree& tree, std::optional<double> volume, ThreadTeam& team) {
  Improvement(mesh, tree, team).FitSurface(volume);
}

}  // namespace fascicle
