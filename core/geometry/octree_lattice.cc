// Reference: Labelle and Shewchuk 2007, "Isosurface Stuffing: Fast Tetrahedral Meshes with Good Dihedral Angles", ACM
// TOG 26(3).
#include "core/geometry/octree_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/check.h"
#include "core/base/stop.h"

namespace fascicle {
namespace {

// Positions must fit a key of 63 bits.
constexpr int kDeepestLevel = 19;

using Position = std::array<std::int32_t, 3>;

// A cube of the octree. Positions are multiples of half the finest leaf's width, so that centres are integers, too.
struct OctreeCell {
  Position lowest;
  std::int32_t width;
  std::int32_t children = -1;  // the first of eight, in the order of bits x, y, z
  bool outside = false;        // wholly outside, and farther from the surface than the finest width

  bool is_leaf() const { return children < 0; }
  Position Centre() const { return {lowest[0] + width / 2, lowest[1] + width / 2, lowest[2] + width / 2}; }
};

class Octree {
 public:
  Octree(const TriangleMesh& surface, const TriangleTree& tree, double width, double grading, ThreadTeam& team)
      : tree_(tree), width_(width), grading_(grading), team_(team) {
    Vec3 lowest = surface.nodes[surface.triangles[0][0]], highest = lowest;
    for (const Triangle& triangle : surface.triangles) {
      for (const std::int32_t n : triangle) {
        lowest = lowest.cwiseMin(surface.nodes[n]);
        highest = highest.cwiseMax(surface.nodes[n]);
      }
    }
    const double wanted = (highest - lowest).maxCoeff() + 4 * width;
    std::int32_t size = 2;
    while (size / 2 * width < wanted) size *= 2;
    FASCICLE_CHECK(size <= (1 << kDeepestLevel), "the lattice is too fine");
    lattice_.half = width / 2;
    lattice_.origin = 0.5 * (lowest + highest) - Vec3::Constant(0.25 * size * width);
    cells_.push_back({{0, 0, 0}, size});
    Refine();
    Balance();
  }

  Lattice Take() {
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      team_.ThrowIfStopped();
      if (cells_[i].is_leaf() && !cells_[i].outside) AddTetrahedra(cells_[i]);
    }
    NumberNodes();
    return std::move(lattice_);
  }

 private:
  Vec3 PointAt(const Position& p) const { return lattice_.origin + lattice_.half * Vec3(p[0], p[1], p[2]); }

  void Split(std::size_t index) {
    const OctreeCell cell = cells_[index];
    cells_[index].children = static_cast<std::int32_t>(cells_.size());
    const std::int32_t half = cell.width / 2;
    for (int child = 0; child < 8; ++child) {
      Position lowest = cell.lowest;
      for (int axis = 0; axis < 3; ++axis) lowest[axis] += (child >> axis & 1) * half;
      cells_.push_back({lowest, half});
    }
  }

  enum class Decision : char { kKeep, kSplit, kOutside };

  Decision Decide(const OctreeCell& cell) const {
    const Vec3 centre = PointAt(cell.Centre());
    const double cell_width = cell.width * lattice_.half, radius = std::numbers::sqrt3 / 2 * cell_width;
    const double distance = tree_.Distance(centre);
    const bool finest = cell.width == 2;
    if (distance < radius + width_) return finest ? Decision::kKeep : Decision::kSplit;
    if (!tree_.IsInside(centre)) return Decision::kOutside;
    return !finest && cell_width > width_ + grading_ * (distance - radius) ? Decision::kSplit : Decision::kKeep;
  }

  void Refine() {
    std::vector<Decision> decisions;
    for (std::size_t first = 0; first < cells_.size();) {
      const std::size_t count = cells_.size() - first;
      decisions.resize(count);
      ForEach(team_, count, 16, [&](std::size_t i) { decisions[i] = Decide(cells_[first + i]); });
      for (std::size_t i = 0; i < count; ++i) {
        if (decisions[i] == Decision::kSplit) Split(first + i);
        cells_[first + i].outside = decisions[i] == Decision::kOutside;
      }
      first += count;
    }
  }

  // The cell of the given width at `lowest`, or the leaf that contains it; null outside of the root.
  const OctreeCell* Find(const Position& lowest, std::int32_t width) const {
    for (const std::int32_t x : lowest) {
      if (x < 0 || x >= cells_[0].width) return nullptr;
    }
    const OctreeCell* cell = &cells_[0];
    while (cell->width > width && !cell->is_leaf()) {
      const std::int32_t half = cell->width / 2;
      int child = 0;
      for (int axis = 0; axis < 3; ++axis) child |= (lowest[axis] >= cell->lowest[axis] + half ? 1 : 0) << axis;
      cell = &cells_[cell->children + child];
    }
    return cell;
  }

  // Makes cells that share an edge differ by a factor of at most two. Cells outside need not: everything that touches
  // them is outside, too.
  void Balance() {
    for (bool changed = true; changed;) {
      changed = false;
      const std::size_t count = cells_.size();
      for (std::size_t i = 0; i < count; ++i) {
        if (!cells_[i].is_leaf() || cells_[i].outside) continue;
        team_.ThrowIfStopped();
        for (int direction = 0; direction < 27; ++direction) {
          const Position step = {direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1};
          const int moved = std::abs(step[0]) + std::abs(step[1]) + std::abs(step[2]);
          if (moved == 0 || moved == 3) continue;
          Position at = cells_[i].lowest;
          for (int axis = 0; axis < 3; ++axis) at[axis] += step[axis] * cells_[i].width;
          const OctreeCell* neighbour = Find(at, cells_[i].width);
          if (neighbour == nullptr || neighbour->outside || neighbour->width <= 2 * cells_[i].width) continue;
          Split(static_cast<std::size_t>(neighbour - cells_.data()));
          changed = true;
        }
      }
    }
  }

  static std::int64_t KeyOf(const Position& p) {
    return (std::int64_t{p[0]} << 42) | (std::int64_t{p[1]} << 21) | std::int64_t{p[2]};
  }

  void Add(const Position& a, const Position& b, const Position& c, const Position& d) {
    const auto edge = [&](const Position& p) { return Vec3(p[0] - a[0], p[1] - a[1], p[2] - a[2]); };
    const double volume = edge(b).cross(edge(c)).dot(edge(d));
    keys_.push_back({KeyOf(a), KeyOf(b), KeyOf(volume > 0 ? c : d), KeyOf(volume > 0 ? d : c)});
  }

  void AddTetrahedra(const OctreeCell& cell) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const int direction : {-1, 1}) {
        Position beyond = cell.lowest;
        beyond[axis] += direction * cell.width;
        const OctreeCell* neighbour = Find(beyond, cell.width);
        if (neighbour == nullptr || neighbour->outside) continue;
        if (neighbour->width > cell.width) {
          AddBesideLarger(cell, *neighbour, axis, direction);
        } else if (!neighbour->is_leaf()) {
          AddBesideSmaller(cell, axis, direction);
        } else if (direction > 0) {
          AddBesideEqual(cell, *neighbour, axis);
        }
      }
    }
  }

  // The corners of a side, in cyclic order.
  static std::array<Position, 4> Ring(const OctreeCell& cell, int axis, int direction) {
    std::array<Position, 4> ring;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int i = 0; i < 4; ++i) {
      ring[i] = cell.lowest;
      if (direction > 0) ring[i][axis] += cell.width;
      if (i == 1 || i == 2) ring[i][u] += cell.width;
      if (i >= 2) ring[i][v] += cell.width;
    }
    return ring;
  }

  static Position Middle(const Position& a, const Position& b) {
    return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
  }

  // Adds, around each edge of the common side, one tetrahedron with both centres, or two where smaller cells split the
  // edge.
  void AddBesideEqual(const OctreeCell& cell, const OctreeCell& neighbour, int axis) {
    const std::array<Position, 4> ring = Ring(cell, axis, 1);
    // Directions to the cells beyond the edge from corner i to i + 1.
    const int across[4] = {(axis + 2) % 3, (axis + 1) % 3, (axis + 2) % 3, (axis + 1) % 3};
    const int sign[4] = {-1, 1, 1, -1};
    for (int i = 0; i < 4; ++i) {
      const Position &a = ring[i], &b = ring[(i + 1) % 4];
      bool halved = false;
      for (const OctreeCell* side : {&cell, &neighbour}) {
        Position beyond = side->lowest;
        beyond[across[i]] += sign[i] * cell.width;
        const OctreeCell* other = Find(beyond, cell.width);
        halved = halved || (other != nullptr && !other->is_leaf());
      }
      if (halved) {
        const Position middle = Middle(a, b);
        Add(cell.Centre(), neighbour.Centre(), a, middle);
        Add(cell.Centre(), neighbour.Centre(), middle, b);
      } else {
        Add(cell.Centre(), neighbour.Centre(), a, b);
      }
    }
  }

  // Adds half a pyramid on each side of the diagonal that ends at the midpoint of the larger cell's side.
  void AddBesideLarger(const OctreeCell& cell, const OctreeCell& larger, int axis, int direction) {
    const std::array<Position, 4> ring = Ring(cell, axis, direction);
    Position middle = larger.Centre();
    middle[axis] = ring[0][axis];
    for (int i = 0; i < 4; ++i) {
      if (ring[i] != middle) continue;
      Add(cell.Centre(), ring[i], ring[(i + 1) % 4], ring[(i + 2) % 4]);
      Add(cell.Centre(), ring[i], ring[(i + 2) % 4], ring[(i + 3) % 4]);
    }
  }

  void AddBesideSmaller(const OctreeCell& cell, int axis, int direction) {
    const std::array<Position, 4> ring = Ring(cell, axis, direction);
    const Position middle = Middle(ring[0], ring[2]);
    for (int i = 0; i < 4; ++i) {
      const Position half = Middle(ring[i], ring[(i + 1) % 4]);
      Add(cell.Centre(), middle, ring[i], half);
      Add(cell.Centre(), middle, half, ring[(i + 1) % 4]);
    }
  }

  void NumberNodes() {
    std::vector<std::int64_t> sorted;
    sorted.reserve(4 * keys_.size());
    for (const auto& keys : keys_) sorted.insert(sorted.end(), keys.begin(), keys.end());
    SortUnlessStopped(sorted, team_.stop());
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    constexpr std::int64_t kMask = (1 << 21) - 1;
    for (const std::int64_t key : sorted) {
      lattice_.positions.push_back({static_cast<std::int32_t>(key >> 42), static_cast<std::int32_t>(key >> 21 & kMask),
                                    static_cast<std::int32_t>(key & kMask)});
    }
    lattice_.tetrahedra.resize(keys_.size());
    ForEach(team_, keys_.size(), 256, [&](std::size_t t) {
      for (int i = 0; i < 4; ++i) {
        const auto at = std::lower_bound(sorted.begin(), sorted.end(), keys_[t][i]);
        lattice_.tetrahedra[t][i] = static_cast<std::int32_t>(at - sorted.begin());
      }
    });
  }

  const TriangleTree& tree_;
  const double width_, grading_;
  ThreadTeam& team_;
  std::vector<OctreeCell> cells_;
  std::vector<std::array<std::int64_t, 4>> keys_;  // of tetrahedra, by their nodes' positions
  Lattice lattice_;
};

}  // namespace

Lattice MakeLattice(const TriangleMesh& surface, const TriangleTree& tree, double width, double grading,
                    ThreadTeam& team) {
  return Octree(surface, tree, width, grading, team).Take();
}

}  // namespace fascicle
