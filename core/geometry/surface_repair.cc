// Reference: Barequet and Sharir 1995, "Filling gaps in the boundary of a polyhedron", Computer Aided Geometric
// Design 12(2).
#include "core/geometry/surface_repair.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "core/base/stop.h"
#include "core/geometry/bounds.h"
#include "core/geometry/faces.h"
#include "core/geometry/triangle_tree.h"
#include "core/geometry/unused_nodes.h"

namespace fascicle {
namespace {

// Filling with least area takes time proportional to the cube of the number of edges. Longer boundaries are filled by a
// fan around their centre.
constexpr std::size_t kLongestBoundary = 300;
constexpr std::size_t kPlacesTold = 5;
constexpr double kNear = 1e-6;  // relative to the diagonal: distance of nodes that are welded, width of slits
// Whether a part is inside of another is decided at this many places of it, at most.
constexpr std::size_t kSamples = 200;

using Loop = std::vector<std::int32_t>;

// An edge as it occurs in one triangle.
struct Side {
  std::int32_t low, high;  // nodes
  std::int32_t triangle;
  bool ascending;  // the triangle goes from low to high
  auto Key() const { return std::pair(low, high); }
};

std::vector<Side> SortedSides(const std::vector<Triangle>& triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t), a < b});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return sides;
}

// Calls visit(first, last) with the sides of each edge.
template <class Visit>
void ForEachEdge(const std::vector<Side>& sides, const Visit& visit) {
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t last = first + 1;
    while (last < sides.size() && sides[last].Key() == sides[first].Key()) ++last;
    visit(first, last);
    first = last;
  }
}

// Disjoint sets of numbers, each represented by its lowest member.
class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::int32_t Root(std::int32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void Join(std::int32_t i, std::int32_t j) {
    const std::int32_t a = Root(i), b = Root(j);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::int32_t> parent_;
};

template <class Nodes>
SurfacePlace PlaceOf(const std::vector<Vec3>& x, const Nodes& nodes) {
  Vec3 lowest = x[*nodes.begin()], highest = lowest;
  for (const std::int32_t n : nodes) {
    lowest = lowest.cwiseMin(x[n]);
    highest = highest.cwiseMax(x[n]);
  }
  SurfacePlace place;
  place.centre = 0.5 * (lowest + highest);
  place.extent = (highest - lowest).norm();
  return place;
}

SurfacePlace PlaceOf(const std::vector<Vec3>& nodes) {
  const Bounds bounds = BoundsOf(nodes);
  SurfacePlace place;
  place.centre = 0.5 * (bounds.lowest + bounds.highest);
  place.extent = bounds.extent().norm();
  return place;
}

// The first few places, formatted for a sentence.
std::string PlacesText(const std::vector<SurfacePlace>& places) {
  std::string text;
  for (std::size_t i = 0; i < std::min(places.size(), kPlacesTold); ++i) {
    text += (i > 0 ? "; " : "") + PlaceText(places[i]);
  }
  return text + (places.size() > kPlacesTold ? "; ..." : "");
}

void JoinNodes(TriangleMesh& surface) {
  const std::vector<Vec3>& x = surface.nodes;
  std::vector<std::int32_t> order(x.size()), joined(x.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    return std::tuple(x[a].x(), x[a].y(), x[a].z(), a) < std::tuple(x[b].x(), x[b].y(), x[b].z(), b);
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    joined[order[i]] = i > 0 && x[order[i]] == x[order[i - 1]] ? joined[order[i - 1]] : order[i];
  }
  for (Triangle& triangle : surface.triangles) {
    for (std::int32_t& n : triangle) n = joined[n];
  }
}

// The cell of a grid that contains a position.
using Cell = std::array<std::int64_t, 3>;

// Joins nodes of open edges (of one triangle) that are nearer than `distance`; some up to three times as far are
// joined, too. Other nodes stay as they are, however near: they are fine detail of a closed surface.
void WeldOpenEdges(double distance, TriangleMesh& surface, SurfaceReport& report) {
  if (!(distance > 0) || !std::isfinite(distance)) return;
  std::vector<char> is_open(surface.nodes.size());
  const std::vector<Side> sides = SortedSides(surface.triangles);
  ForEachEdge(sides, [&](std::size_t first, std::size_t last) {
    if (last - first == 1) is_open[sides[first].low] = is_open[sides[first].high] = 1;
  });
  const Vec3 lowest = BoundsOf(surface.nodes).lowest;
  const auto cell_of = [&](const Vec3& x) {
    const Vec3 at = ((x - lowest) / (2 * distance)).array().floor();
    return Cell{std::int64_t(at.x()), std::int64_t(at.y()), std::int64_t(at.z())};
  };
  // The first node of each cell that has any. Nodes in a cell are joined with it, and with those of the cells that a
  // cube of twice the distance around the node touches.
  std::map<Cell, std::int32_t> first_in;
  UnionFind joined(surface.nodes.size());
  for (std::size_t n = 0; n < is_open.size(); ++n) {
    if (!is_open[n]) continue;
    const auto node = static_cast<std::int32_t>(n);
    joined.Join(node, first_in.try_emplace(cell_of(surface.nodes[n]), node).first->second);
  }
  for (std::size_t n = 0; n < is_open.size(); ++n) {
    for (int corner = 0; is_open[n] && corner < 8; ++corner) {
      Vec3 at = surface.nodes[n];
      for (int axis = 0; axis < 3; ++axis) at[axis] += (corner >> axis & 1) ? distance : -distance;
      const auto found = first_in.find(cell_of(at));
      if (found != first_in.end()) joined.Join(static_cast<std::int32_t>(n), found->second);
    }
  }
  for (std::size_t n = 0; n < is_open.size(); ++n) {
    if (joined.Root(static_cast<std::int32_t>(n)) != static_cast<std::int32_t>(n)) ++report.welded_nodes;
  }
  if (report.welded_nodes == 0) return;
  report.weld_distance = distance;
  for (Triangle& triangle : surface.triangles) {
    for (std::int32_t& n : triangle) n = joined.Root(n);
  }
}

// Whether two triangles with the same nodes have the same orientation.
bool SameWay(const Triangle& a, const Triangle& b) {
  const auto at = std::find(b.begin(), b.end(), a[0]) - b.begin();
  return b[(at + 1) % 3] == a[1];
}

// Keeps one of opposite twins where the surface would otherwise have a hole.
void KeepCovers(const TriangleMesh& surface, const std::vector<std::size_t>& opposed, std::vector<char>& gone) {
  if (opposed.empty()) return;
  std::map<std::array<std::int32_t, 2>, int> sides;  // number of triangles that remain at each edge
  const auto edge = [&](std::size_t t, int k) {
    const std::int32_t a = surface.triangles[t][k], b = surface.triangles[t][(k + 1) % 3];
    return std::array{std::min(a, b), std::max(a, b)};
  };
  for (std::size_t t = 0; t < gone.size(); ++t) {
    for (int k = 0; !gone[t] && k < 3; ++k) ++sides[edge(t, k)];
  }
  for (const std::size_t t : opposed) {
    bool covers = true;
    for (int k = 0; k < 3; ++k) covers = covers && sides[edge(t, k)] == 1;
    if (covers) gone[t] = 0;
  }
}

// Removes triangles without area and duplicates. Of two opposite triangles with the same nodes both are removed, unless
// all their edges would be open then.
void RemoveTriangles(TriangleMesh& surface, SurfaceReport& report) {
  const std::size_t before = surface.triangles.size();
  std::erase_if(surface.triangles, [&](const Triangle& t) {
    const Vec3 ab = surface.nodes[t[1]] - surface.nodes[t[0]], ac = surface.nodes[t[2]] - surface.nodes[t[0]];
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || ab.cross(ac).isZero(0);
  });
  std::map<Triangle, std::vector<std::size_t>> same;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) same[Ascending(surface.triangles[t])].push_back(t);
  std::vector<char> gone(surface.triangles.size());
  std::vector<std::size_t> opposed;
  for (const auto& [nodes, triangles] : same) {
    std::int64_t net = 0;  // those oriented like the first minus the opposite ones
    for (const std::size_t t : triangles) {
      net += SameWay(surface.triangles[triangles[0]], surface.triangles[t]) ? 1 : -1;
    }
    if (net == 0) opposed.push_back(triangles[0]);
    bool kept = net == 0;
    for (const std::size_t t : triangles) {
      const bool like_most = SameWay(surface.triangles[triangles[0]], surface.triangles[t]) == (net > 0);
      gone[t] = kept || !like_most;
      kept = kept || like_most;
    }
  }
  KeepCovers(surface, opposed, gone);
  std::size_t t = 0;
  std::erase_if(surface.triangles, [&](const Triangle&) { return gone[t++] != 0; });
  report.removed_triangles += static_cast<std::int64_t>(before - surface.triangles.size());
}

double LongestEdge(const TriangleMesh& surface, const Triangle& t) {
  const Vec3 &a = surface.nodes[t[0]], &b = surface.nodes[t[1]], &c = surface.nodes[t[2]];
  return std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
}

// Removes triangles without width that hang on edges of more than two triangles.
void RemoveHangingSlivers(double width, TriangleMesh& surface, SurfaceReport& report) {
  std::vector<char> gone(surface.triangles.size());
  const std::vector<Side> sides = SortedSides(surface.triangles);
  ForEachEdge(sides, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; last - first > 2 && i < last; ++i) {
      const Triangle& t = surface.triangles[sides[i].triangle];
      const Vec3 ab = surface.nodes[t[1]] - surface.nodes[t[0]], ac = surface.nodes[t[2]] - surface.nodes[t[0]];
      if (ab.cross(ac).norm() <= width * LongestEdge(surface, t)) gone[sides[i].triangle] = 1;
    }
  });
  std::size_t t = 0;
  report.removed_triangles +=
      static_cast<std::int64_t>(std::erase_if(surface.triangles, [&](const Triangle&) { return gone[t++] != 0; }));
}

// Orients triangles consistently: neighbours must traverse their common edge in opposite directions. Starts at the
// lowest triangle of each part and reports where consistency is impossible.
void OrientNeighbours(TriangleMesh& surface, SurfaceReport& report, Problems& problems) {
  struct Neighbour {
    std::int32_t triangle;
    bool against;
  };
  std::vector<std::vector<Neighbour>> neighbours(surface.triangles.size());
  const std::vector<Side> sides = SortedSides(surface.triangles);
  ForEachEdge(sides, [&](std::size_t first, std::size_t last) {
    if (last - first != 2) return;
    const Side &a = sides[first], &b = sides[first + 1];
    neighbours[a.triangle].push_back({b.triangle, a.ascending == b.ascending});
    neighbours[b.triangle].push_back({a.triangle, a.ascending == b.ascending});
  });
  std::vector<signed char> turn(surface.triangles.size(), -1);
  std::vector<SurfacePlace> one_sided;
  for (std::size_t start = 0; start < turn.size(); ++start) {
    if (turn[start] >= 0) continue;
    std::vector<std::int32_t> part = {static_cast<std::int32_t>(start)};
    turn[start] = 0;
    std::optional<std::int32_t> conflict;
    std::size_t turned = 0;
    for (std::size_t i = 0; i < part.size(); ++i) {
      turned += turn[part[i]];
      for (const auto& [next, against] : neighbours[part[i]]) {
        const auto wanted = static_cast<signed char>(turn[part[i]] ^ (against ? 1 : 0));
        if (turn[next] < 0) {
          turn[next] = wanted;
          part.push_back(next);
        } else if (turn[next] != wanted && !conflict) {
          conflict = next;
        }
      }
    }
    if (conflict) one_sided.push_back(PlaceOf(surface.nodes, surface.triangles[*conflict]));
    // The majority keeps its orientation.
    const signed char change = 2 * turned > part.size() ? 0 : 1;
    for (const std::int32_t t : part) {
      if (turn[t] != change) continue;
      std::swap(surface.triangles[t][1], surface.triangles[t][2]);
      ++report.turned_triangles;
    }
  }
  if (one_sided.empty()) return;
  problems.Add("", "the surface is one-sided (a Moebius strip) at " + PlacesText(one_sided),
               "remove the triangles there, so that the hole can be filled");
}

// Boundaries of holes, in the direction of the triangles that would fill them.
std::vector<Loop> Boundaries(const TriangleMesh& surface, Problems& problems) {
  std::multimap<std::int32_t, std::int32_t> next;
  std::vector<SurfacePlace> crowded;
  const std::vector<Side> sides = SortedSides(surface.triangles);
  ForEachEdge(sides, [&](std::size_t first, std::size_t last) {
    std::int64_t net = 0;
    for (std::size_t i = first; i < last; ++i) net += sides[i].ascending ? 1 : -1;
    const auto [low, high] = sides[first].Key();
    if (net == 0) return;
    if (last - first > 2) {
      crowded.push_back(PlaceOf(surface.nodes, std::array{low, high}));
    } else {
      net > 0 ? next.emplace(high, low) : next.emplace(low, high);
    }
  });
  if (!crowded.empty()) {
    problems.Add("",
                 std::to_string(crowded.size()) +
                     " edges belong to three or more triangles and do not bound a volume, at " + PlacesText(crowded),
                 "remove sheets that hang on the surface or stand inside of it");
    return {};
  }
  std::vector<Loop> loops;
  while (!next.empty()) {
    // Where boundaries touch, each return to a node closes a loop.
    Loop path = {next.begin()->first};
    while (!path.empty()) {
      const auto step = next.find(path.back());
      if (step == next.end()) break;
      const std::int32_t to = step->second;
      next.erase(step);
      const auto met = std::find(path.begin(), path.end(), to);
      if (met == path.end()) {
        path.push_back(to);
        continue;
      }
      loops.emplace_back(met, path.end());
      path.erase(met + 1, path.end());
      if (path.size() == 1 && next.find(path.back()) == next.end()) break;
    }
  }
  return loops;
}

// Fills a boundary with triangles of least total area, by dynamic programming.
void FillWithLeastArea(const Loop& loop, TriangleMesh& surface) {
  const std::size_t n = loop.size();
  const auto area = [&](std::size_t i, std::size_t j, std::size_t k) {
    const Vec3 &a = surface.nodes[loop[i]], &b = surface.nodes[loop[j]], &c = surface.nodes[loop[k]];
    return (b - a).cross(c - a).norm();
  };
  std::vector<double> least(n * n, 0);
  std::vector<std::size_t> middle(n * n, 0);
  for (std::size_t span = 2; span < n; ++span) {
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t k = i + span;
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t j = i + 1; j < k; ++j) {
        const double sum = least[i * n + j] + least[j * n + k] + area(i, j, k);
        if (!(sum < best)) continue;
        best = sum;
        middle[i * n + k] = j;
      }
      least[i * n + k] = best;
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> parts = {{0, n - 1}};
  while (!parts.empty()) {
    const auto [i, k] = parts.back();
    parts.pop_back();
    if (k - i < 2) continue;
    const std::size_t j = middle[i * n + k];
    surface.triangles.push_back({loop[i], loop[j], loop[k]});
    parts.push_back({i, j});
    parts.push_back({j, k});
  }
}

void FillWithFan(const Loop& loop, TriangleMesh& surface) {
  Vec3 middle = Vec3::Zero();
  for (const std::int32_t n : loop) middle += surface.nodes[n] / static_cast<double>(loop.size());
  const auto node = static_cast<std::int32_t>(surface.nodes.size());
  surface.nodes.push_back(middle);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    surface.triangles.push_back({loop[i], loop[(i + 1) % loop.size()], node});
  }
}

// Whether all nodes of a boundary are within `width` of one line.
bool IsSlit(const TriangleMesh& surface, const Loop& loop, double width) {
  const auto furthest_from = [&](const Vec3& from) {
    return surface.nodes[*std::max_element(loop.begin(), loop.end(), [&](std::int32_t a, std::int32_t b) {
      return (surface.nodes[a] - from).squaredNorm() < (surface.nodes[b] - from).squaredNorm();
    })];
  };
  const Vec3 end = furthest_from(surface.nodes[loop[0]]);
  const Vec3 along = (furthest_from(end) - end).normalized();
  return std::all_of(loop.begin(), loop.end(),
                     [&](std::int32_t n) { return (surface.nodes[n] - end).cross(along).norm() <= width; });
}

void FillHoles(TriangleMesh& surface, double largest_hole, double slit_width, const std::stop_token& stop,
               SurfaceReport& report, Problems& problems) {
  std::vector<SurfacePlace> too_large;
  for (const Loop& loop : Boundaries(surface, problems)) {
    ThrowIfStopped(stop);
    SurfacePlace place = PlaceOf(surface.nodes, loop);
    place.count = static_cast<std::int64_t>(loop.size());
    for (std::size_t i = 0; i < loop.size(); ++i) {
      place.length += (surface.nodes[loop[(i + 1) % loop.size()]] - surface.nodes[loop[i]]).norm();
    }
    if (IsSlit(surface, loop, slit_width)) {
      ++report.closed_slits;
    } else if (place.extent > largest_hole) {
      too_large.push_back(place);
      continue;
    } else {
      report.holes.push_back(place);
    }
    loop.size() <= kLongestBoundary ? FillWithLeastArea(loop, surface) : FillWithFan(loop, surface);
  }
  for (std::size_t i = 0; i < too_large.size() && i < kPlacesTold; ++i) {
    char text[160];
    std::snprintf(text, sizeof(text), ", with a boundary of %lld edges, %.4g long; holes up to %.4g across are filled",
                  static_cast<long long>(too_large[i].count), too_large[i].length, largest_hole);
    problems.Add("", "the surface has a hole at " + PlaceText(too_large[i]) + text,
                 "close it, or fill larger holes: `fascicle mesh --max-hole LENGTH`");
  }
  if (too_large.size() > kPlacesTold) {
    problems.Add("", "and " + std::to_string(too_large.size() - kPlacesTold) + " more holes of that kind",
                 "is this a surface around a body, and is the file complete?");
  }
}

// The edge-connected parts, ordered by their lowest triangle.
std::vector<std::vector<std::int32_t>> Parts(const TriangleMesh& surface) {
  UnionFind joined(surface.triangles.size());
  const std::vector<Side> sides = SortedSides(surface.triangles);
  ForEachEdge(sides, [&](std::size_t first, std::size_t last) {
    // Two bodies that touch along an edge stay separate.
    if (last - first == 2) joined.Join(sides[first].triangle, sides[first + 1].triangle);
  });
  std::map<std::int32_t, std::vector<std::int32_t>> parts;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    parts[joined.Root(static_cast<std::int32_t>(t))].push_back(static_cast<std::int32_t>(t));
  }
  std::vector<std::vector<std::int32_t>> list;
  for (auto& [root, triangles] : parts) list.push_back(std::move(triangles));
  return list;
}

// A part of the surface, with only its own nodes.
TriangleMesh PartOf(const TriangleMesh& surface, const std::vector<std::int32_t>& triangles) {
  TriangleMesh part;
  std::map<std::int32_t, std::int32_t> number;
  for (const std::int32_t t : triangles) {
    Triangle& triangle = part.triangles.emplace_back(surface.triangles[t]);
    for (std::int32_t& n : triangle) {
      const auto [found, is_new] = number.try_emplace(n, static_cast<std::int32_t>(part.nodes.size()));
      if (is_new) part.nodes.push_back(surface.nodes[n]);
      n = found->second;
    }
  }
  return part;
}

// Whether `part` lies inside of the closed surface of `tree`.
bool IsInside(const TriangleMesh& part, const TriangleTree& tree) {
  const std::size_t step = 1 + part.triangles.size() / kSamples;
  for (std::size_t t = 0; t < part.triangles.size(); t += step) {
    const auto& [a, b, c] = part.triangles[t];
    if (!tree.IsInside((part.nodes[a] + part.nodes[b] + part.nodes[c]) / 3)) return false;
  }
  return true;
}

// In how many other parts each part lies. All parts must be oriented outward.
std::vector<int> Depths(const std::vector<TriangleMesh>& parts, const std::stop_token& stop) {
  std::vector<Bounds> bounds;
  for (const TriangleMesh& part : parts) bounds.push_back(BoundsOf(part.nodes));
  std::vector<int> depths(parts.size());
  for (std::size_t outer = 0; outer < parts.size(); ++outer) {
    std::optional<TriangleTree> tree;
    for (std::size_t inner = 0; inner < parts.size(); ++inner) {
      ThrowIfStopped(stop);
      const bool may_be = inner != outer && (bounds[inner].lowest.array() >= bounds[outer].lowest.array()).all() &&
                          (bounds[inner].highest.array() <= bounds[outer].highest.array()).all();
      if (!may_be) continue;
      if (!tree) tree.emplace(parts[outer]);
      if (IsInside(parts[inner], *tree)) ++depths[inner];
    }
  }
  return depths;
}

// Orients each part outward, or inward if it is a cavity: its orientation alone does not tell, since many programs
// write all surfaces outward.
void OrientParts(TriangleMesh& surface, const std::stop_token& stop, SurfaceReport& report) {
  const std::vector<std::vector<std::int32_t>> lists = Parts(surface);
  report.parts = static_cast<std::int64_t>(lists.size());
  std::vector<TriangleMesh> parts;
  std::vector<char> is_inward;
  for (const auto& list : lists) {
    TriangleMesh& part = parts.emplace_back(PartOf(surface, list));
    is_inward.push_back(EnclosedVolume(part) < 0);
    if (!is_inward.back()) continue;
    for (Triangle& triangle : part.triangles) std::swap(triangle[1], triangle[2]);
  }
  const std::vector<int> depths = Depths(parts, stop);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const bool is_cavity = depths[p] % 2 != 0;
    if (is_cavity) report.cavities.push_back(PlaceOf(parts[p].nodes));
    if (is_cavity == (is_inward[p] != 0)) continue;
    for (const std::int32_t t : lists[p]) std::swap(surface.triangles[t][1], surface.triangles[t][2]);
    report.turned_triangles += static_cast<std::int64_t>(lists[p].size());
  }
}

// Finds pairs of triangles that intersect and groups connected ones into places.
void FindCuts(const TriangleMesh& surface, const std::stop_token& stop, SurfaceReport& report) {
  const auto pairs = TriangleTree(surface).CuttingPairs(stop);
  UnionFind joined(surface.nodes.size());
  const auto node = [&](std::int32_t t) { return surface.triangles[t][0]; };
  for (const auto& [s, t] : pairs) {
    for (const std::int32_t n : surface.triangles[s]) joined.Join(node(s), n);
    for (const std::int32_t n : surface.triangles[t]) joined.Join(node(s), n);
  }
  std::map<std::int32_t, std::pair<std::vector<std::int32_t>, std::int64_t>> places;
  for (const auto& [s, t] : pairs) {
    auto& [nodes, count] = places[joined.Root(node(s))];
    nodes.insert(nodes.end(), surface.triangles[s].begin(), surface.triangles[s].end());
    nodes.insert(nodes.end(), surface.triangles[t].begin(), surface.triangles[t].end());
    ++count;
  }
  for (const auto& [root, found] : places) {
    SurfacePlace place = PlaceOf(surface.nodes, found.first);
    place.count = found.second;
    report.cuts.push_back(place);
  }
}

}  // namespace

std::string PlaceText(const SurfacePlace& place) {
  char text[128];
  std::snprintf(text, sizeof(text), "(%.4g, %.4g, %.4g), %.3g across", place.centre.x(), place.centre.y(),
                place.centre.z(), place.extent);
  return text;
}

SurfaceReport RepairSurface(TriangleMesh& surface, double largest_hole, Problems& problems,
                            const std::stop_token& stop) {
  SurfaceReport report;
  const std::size_t before = problems.count();
  JoinNodes(surface);
  ThrowIfStopped(stop);
  RemoveTriangles(surface, report);
  DropUnusedNodes(surface.nodes, surface.triangles);
  const double near = kNear * Diagonal(surface.nodes);
  WeldOpenEdges(near, surface, report);
  if (report.welded_nodes > 0) RemoveTriangles(surface, report);
  RemoveHangingSlivers(near, surface, report);
  DropUnusedNodes(surface.nodes, surface.triangles);
  if (surface.triangles.empty()) {
    problems.Add("", "the surface has no triangles with an area", "is it flat, or scaled to nothing?");
    return report;
  }
  ThrowIfStopped(stop);
  OrientNeighbours(surface, report, problems);
  FillHoles(surface, largest_hole, near, stop, report, problems);
  if (problems.count() > before) return report;
  OrientParts(surface, stop, report);
  FindCuts(surface, stop, report);
  return report;
}

}  // namespace fascicle
