#include "core/geometry/mesh_checks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "core/base/stop.h"
#include "core/geometry/faces.h"
#include "core/geometry/hexahedron.h"
#include "core/geometry/quadratic_hexahedron.h"
#include "core/geometry/quadratic_tetrahedron.h"
#include "core/geometry/solid_cells.h"

namespace fascicle {
namespace {

constexpr std::size_t kExamples = 5;
// A tetrahedron is degenerate when its smallest height is less than this part of its longest edge. Its stable time step
// would shrink by the same factor.
constexpr double kFlat = 1e-6;
// Nodes closer than this part of the diagonal coincide.
constexpr double kCoincident = 1e-9;
constexpr double kLargest = 10, kSmallest = 1e-4;  // [m]

// Counts occurrences and reports them like "3 tetrahedra are inverted: 4, 7, 9 (counted from 0)".
class Findings {
 public:
  void Add(std::string example) {
    if (++count_ <= kExamples) examples_ += (count_ > 1 ? ", " : "") + std::move(example);
  }
  void Add(std::size_t index) { Add(std::to_string(index)); }
  std::size_t count() const { return count_; }

  // `one` and `many` follow the count: "tetrahedron is inverted", "tetrahedra are inverted".
  void Report(const std::string& one, const std::string& many, const std::string& hint, Problems& problems) const {
    if (count_ == 0) return;
    const std::string more = count_ > kExamples ? ", ..." : "";
    problems.Add(
        "", std::to_string(count_) + " " + (count_ == 1 ? one : many) + ": " + examples_ + more + " (counted from 0)",
        hint);
  }

 private:
  std::size_t count_ = 0;
  std::string examples_;
};

void CheckNotEmpty(const TetMesh& mesh, Problems& problems) {
  if (mesh.tetrahedra.empty()) {
    problems.Add("", "the mesh has no tetrahedra", "fill the surface with tetrahedra of four nodes");
  }
}

void CheckCoordinates(const TetMesh& mesh, Problems& problems) {
  Findings findings;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (!mesh.nodes[n].allFinite()) findings.Add(n);
  }
  findings.Report("node has a coordinate that is not a finite number",
                  "nodes have coordinates that are not finite numbers", "write the mesh again", problems);
}

template <class Cell>
bool InRange(const Cell& cell, std::size_t nodes) {
  return std::all_of(cell.begin(), cell.end(), [&](std::int32_t n) { return n >= 0 && std::size_t(n) < nodes; });
}

void CheckIndices(const TetMesh& mesh, Problems& problems) {
  Findings tetrahedra, triangles;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    if (!InRange(mesh.tetrahedra[t], mesh.nodes.size())) tetrahedra.Add(t);
  }
  for (std::size_t t = 0; t < mesh.tagged_triangles.size(); ++t) {
    if (!InRange(mesh.tagged_triangles[t], mesh.nodes.size())) triangles.Add(t);
  }
  Findings points;
  for (std::size_t p = 0; p < mesh.tagged_nodes.size(); ++p) {
    if (!InRange(std::array{mesh.tagged_nodes[p]}, mesh.nodes.size())) points.Add(p);
  }
  const std::string hint = "the mesh has " + std::to_string(mesh.nodes.size()) + " nodes";
  tetrahedra.Report("tetrahedron refers to a node that does not exist", "tetrahedra refer to nodes that do not exist",
                    hint, problems);
  triangles.Report("triangle refers to a node that does not exist", "triangles refer to nodes that do not exist", hint,
                   problems);
  points.Report("point refers to a node that does not exist", "points refer to nodes that do not exist", hint,
                problems);
}

bool IsDegenerate(const TetMesh& mesh, std::size_t t, double volume) {
  const Tetrahedron& nodes = mesh.tetrahedra[t];
  double longest = 0, largest_side = 0;  // [m], [m^2]
  for (int side = 0; side < 4; ++side) {
    const auto& [a, b, c] = OutwardTriangle(nodes, side);
    const Vec3 ab = mesh.nodes[b] - mesh.nodes[a], ac = mesh.nodes[c] - mesh.nodes[a];
    longest = std::max({longest, ab.norm(), ac.norm()});
    largest_side = std::max(largest_side, ab.cross(ac).norm() / 2);
  }
  return !(3 * std::abs(volume) > kFlat * longest * largest_side);
}

void CheckVolumes(const TetMesh& mesh, const std::stop_token& stop, Problems& problems) {
  Findings inverted, degenerate;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    ThrowIfStopped(stop);
    const double volume = SignedVolume(mesh, t);
    if (!std::isfinite(volume)) continue;  // reported by CheckCoordinates
    if (IsDegenerate(mesh, t, volume)) {
      degenerate.Add(t);
    } else if (volume < 0) {
      inverted.Add(t);
    }
  }
  inverted.Report("tetrahedron is inverted (negative volume)", "tetrahedra are inverted (negative volume)",
                  "swap two nodes of each, or mesh the body again", problems);
  degenerate.Report("tetrahedron is degenerate (flat)", "tetrahedra are degenerate (flat)",
                    "mesh the body again, with optimization switched on", problems);
}

void CheckDuplicates(const TetMesh& mesh, const std::stop_token& stop, Problems& problems) {
  std::vector<std::pair<Tetrahedron, std::size_t>> sorted(mesh.tetrahedra.size());
  for (std::size_t t = 0; t < sorted.size(); ++t) {
    sorted[t] = {mesh.tetrahedra[t], t};
    std::sort(sorted[t].first.begin(), sorted[t].first.end());
  }
  SortUnlessStopped(sorted, stop);
  std::set<std::size_t> duplicates;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i].first == sorted[i - 1].first) duplicates.insert(sorted[i].second);
  }
  Findings findings;
  for (const std::size_t t : duplicates) findings.Add(t);
  findings.Report("tetrahedron has the same nodes as another", "tetrahedra have the same nodes as others",
                  "remove the duplicates", problems);
}

void CheckUnusedNodes(const TetMesh& mesh, const std::stop_token& stop, Problems& problems) {
  std::vector<char> used(mesh.nodes.size());
  for (const Tetrahedron& tetrahedron : mesh.tetrahedra) {
    ThrowIfStopped(stop);
    for (const std::int32_t n : tetrahedron) used[n] = 1;
  }
  Findings findings;
  for (std::size_t n = 0; n < used.size(); ++n) {
    if (!used[n]) findings.Add(n);
  }
  findings.Report("node belongs to no tetrahedron", "nodes belong to no tetrahedron",
                  "remove them, or write volume elements only", problems);
}

using Cell = std::array<std::int64_t, 3>;

// Nodes in the same cell of a fine grid coincide. So do nodes in neighbouring cells when one of them is within a tenth
// of a cell of the other's cell; every pair that close is found. A node is compared only with the lowest node of each
// cell, not with all nodes in it: O(n log n) for any mesh.
void CheckCoincidentNodes(const TetMesh& mesh, const MeshReport& report, const std::stop_token& stop,
                          Problems& problems) {
  const double width = kCoincident * (report.highest - report.lowest).norm();
  if (!(width > 0) || !std::isfinite(width)) return;
  const auto cell_of = [&](const Vec3& x) {
    const Vec3 at = ((x - report.lowest) / width).array().floor();
    return Cell{std::int64_t(at.x()), std::int64_t(at.y()), std::int64_t(at.z())};
  };
  std::vector<std::pair<Cell, std::size_t>> cells;
  cells.reserve(mesh.nodes.size());
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.nodes[n].allFinite()) cells.push_back({cell_of(mesh.nodes[n]), n});
  }
  SortUnlessStopped(cells, stop);
  // The lowest node of a cell; none if it is empty.
  const auto first_in = [&](const Cell& cell) {
    const auto found = std::lower_bound(cells.begin(), cells.end(), std::pair(cell, std::size_t{0}));
    return found != cells.end() && found->first == cell ? found->second : std::numeric_limits<std::size_t>::max();
  };
  std::vector<std::pair<std::size_t, std::size_t>> twins;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    ThrowIfStopped(stop);
    const auto& [cell, n] = cells[i];
    std::size_t twin = i > 0 && cells[i - 1].first == cell ? first_in(cell) : std::numeric_limits<std::size_t>::max();
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 shift;
      for (int axis = 0; axis < 3; ++axis) shift[axis] = (corner >> axis & 1 ? 0.1 : -0.1) * width;
      const Cell near = cell_of(mesh.nodes[n] + shift);
      if (near != cell) twin = std::min(twin, first_in(near));
    }
    if (twin < n) twins.push_back({twin, n});
  }
  std::sort(twins.begin(), twins.end());
  Findings findings;
  for (const auto& [twin, n] : twins) findings.Add(std::to_string(twin) + " and " + std::to_string(n));
  findings.Report("node coincides with another", "nodes coincide with others",
                  "merge them: the body is disconnected there", problems);
}

// Counts the face-connected parts by union-find; also finds faces with more than two sides.
int CheckComponents(const TetMesh& mesh, const std::stop_token& stop, Problems& problems) {
  std::vector<std::int64_t> parent(mesh.tetrahedra.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int64_t t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  Findings crowded;
  const std::vector<Face> faces = SortedFaces(mesh.tetrahedra, stop);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    ThrowIfStopped(stop);
    if (faces[i].nodes != faces[i - 1].nodes) continue;
    const std::int64_t a = root(faces[i].side / 4), b = root(faces[i - 1].side / 4);
    parent[std::max(a, b)] = std::min(a, b);
    if (i >= 2 && faces[i - 2].nodes == faces[i].nodes) crowded.Add(std::size_t(faces[i].side / 4));
  }
  crowded.Report("tetrahedron has a face that two others already share",
                 "tetrahedra have faces that two others already share", "tetrahedra overlap: mesh the body again",
                 problems);
  Findings parts;
  for (std::size_t t = 0; t < parent.size(); ++t) {
    if (root(std::int64_t(t)) == std::int64_t(t)) parts.Add("tetrahedron " + std::to_string(t));
  }
  if (parts.count() > 1) {
    parts.Report("", "separate parts without a common face, beginning at",
                 "give each part as a body of its own, or merge their nodes", problems);
  }
  return static_cast<int>(parts.count());
}

std::string Metres(double length) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g m", length);
  return text;
}

void CheckSize(const MeshReport& report, Problems& problems) {
  const double longest = (report.highest - report.lowest).maxCoeff();
  if (longest > kLargest) {
    // A muscle in centimetres is 1 to 100 m long, one in millimetres 10 to 1000 m.
    const std::string hint =
        longest >= 100 ? "it is in millimetres: set \"unit\": \"mm\""
                       : "its lengths are likely in centimetres or millimetres: set \"unit\": \"cm\" or \"mm\"";
    problems.Add("", "the body is " + Metres(longest) + " long; no muscle is longer than 10 m", hint);
  } else if (longest < kSmallest && longest > 0) {
    problems.Add("", "the body is " + Metres(longest) + " long; no muscle is shorter than 0.1 mm",
                 "its lengths are likely in a larger unit: set \"unit\": \"m\"");
  }
}

void MeasureBox(const TetMesh& mesh, MeshReport& report) {
  bool any = false;
  for (const Vec3& node : mesh.nodes) {
    if (!node.allFinite()) continue;
    report.lowest = any ? Vec3(report.lowest.cwiseMin(node)) : node;
    report.highest = any ? Vec3(report.highest.cwiseMax(node)) : node;
    any = true;
  }
}

// The smallest dihedral angle of all tetrahedra [rad].
double SmallestDihedralAngle(const TetMesh& mesh, const std::stop_token& stop) {
  double smallest = mesh.tetrahedra.empty() ? 0 : std::numbers::pi;
  for (const Tetrahedron& tetrahedron : mesh.tetrahedra) {
    ThrowIfStopped(stop);
    std::array<Vec3, 4> normals;
    for (int side = 0; side < 4; ++side) {
      const auto& [a, b, c] = OutwardTriangle(tetrahedron, side);
      normals[side] = (mesh.nodes[b] - mesh.nodes[a]).cross(mesh.nodes[c] - mesh.nodes[a]);
    }
    for (int a = 0; a < 4; ++a) {
      for (int b = a + 1; b < 4; ++b) {
        smallest = std::min(smallest, std::atan2(normals[a].cross(normals[b]).norm(), -normals[a].dot(normals[b])));
      }
    }
  }
  return smallest;
}

// Whether a ten-node element has a positive Jacobian at its corners and at the quadrature points of degree two.
bool IsUpright(const std::array<Vec3, 10>& x) {
  for (const auto& [at, rest] : {std::pair(1.0, 0.0), std::pair(kNearCorner, kFarCorner)}) {
    for (int c = 0; c < 4; ++c) {
      std::array<double, 4> L;
      L.fill(rest);
      L[c] = at;
      const auto y = CornersAt(x, L);
      if (!((y[1] - y[0]).cross(y[2] - y[0]).dot(y[3] - y[0]) > 0)) return false;
    }
  }
  return true;
}

// Checks that every curved edge is an edge of the mesh, occurs once, has a finite midpoint and folds no tetrahedron.
void CheckCurvedEdges(const TetMesh& mesh, const std::stop_token& stop, Problems& problems) {
  if (mesh.curved_edges.empty()) return;
  std::map<std::array<std::int32_t, 2>, Vec3> middles;
  Findings wrong, folded;
  for (std::size_t k = 0; k < mesh.curved_edges.size(); ++k) {
    const CurvedEdge& edge = mesh.curved_edges[k];
    const auto [i, j] = std::minmax(edge.ends[0], edge.ends[1]);
    if (!edge.middle.allFinite() || !middles.try_emplace({i, j}, edge.middle).second) wrong.Add(k);
  }
  std::set<std::array<std::int32_t, 2>> met;
  // Whether a hexahedron is folded depends on its element, which a scene's check knows.
  for (const Hexahedron& hexahedron : mesh.hexahedra) {
    ThrowIfStopped(stop);
    if (!InRange(hexahedron, mesh.nodes.size())) continue;  // reported by CheckHexahedra
    for (const auto& [a, b] : kHexEdges) {
      const auto [i, j] = std::minmax(hexahedron[a], hexahedron[b]);
      met.insert({i, j});
    }
  }
  for (std::size_t t = 0; t < mesh.tetrahedra.size() && mesh.hexahedra.empty(); ++t) {
    ThrowIfStopped(stop);
    std::array<Vec3, 10> x;
    bool is_curved = false;
    for (int c = 0; c < 4; ++c) x[c] = mesh.nodes[mesh.tetrahedra[t][c]];
    for (int k = 0; k < 6; ++k) {
      const auto [i, j] = std::minmax(mesh.tetrahedra[t][kTetEdges[k][0]], mesh.tetrahedra[t][kTetEdges[k][1]]);
      const auto found = middles.find({i, j});
      x[4 + k] = found != middles.end() ? found->second : Vec3(0.5 * (mesh.nodes[i] + mesh.nodes[j]));
      if (found == middles.end()) continue;
      is_curved = true;
      met.insert({i, j});
    }
    if (is_curved && SignedVolume(mesh, t) > 0 && !IsUpright(x)) folded.Add(t);
  }
  for (std::size_t k = 0; k < mesh.curved_edges.size(); ++k) {
    const auto [i, j] = std::minmax(mesh.curved_edges[k].ends[0], mesh.curved_edges[k].ends[1]);
    if (met.count({i, j}) == 0) wrong.Add(k);
  }
  wrong.Report("curved edge is not an edge of the mesh, is given twice or has no finite midpoint",
               "curved edges are not edges of the mesh, are given twice or have no finite midpoint",
               "mesh the body again", problems);
  folded.Report("tetrahedron is folded by its curved edges", "tetrahedra are folded by their curved edges",
                "mesh the body again, with optimization of high-order elements switched on", problems);
}

// Checks that hexahedra are made of their tetrahedra, and are not folded at the points of a 2 x 2 x 2 quadrature.
void CheckHexahedra(const TetMesh& mesh, const std::stop_token& stop, Problems& problems) {
  if (mesh.hexahedra.empty()) return;
  constexpr double kNear = 0.21132486540518711775;  // (1 - 1/sqrt(3)) / 2
  Findings wrong, folded, collapsed;
  const std::vector<std::size_t> first = FirstTetrahedra(mesh);
  for (std::size_t h = 0; h < mesh.hexahedra.size(); ++h) {
    ThrowIfStopped(stop);
    const Hexahedron& nodes = mesh.hexahedra[h];
    if (!SolidOf(nodes)) {
      collapsed.Add(h);
      continue;
    }
    bool fits = InRange(nodes, mesh.nodes.size()) && first[h + 1] <= mesh.tetrahedra.size();
    for (std::size_t t = first[h]; fits && t < first[h + 1]; ++t) {
      fits = std::all_of(mesh.tetrahedra[t].begin(), mesh.tetrahedra[t].end(),
                         [&](std::int32_t n) { return std::find(nodes.begin(), nodes.end(), n) != nodes.end(); });
    }
    if (!fits) {
      wrong.Add(h);
      continue;
    }
    const HexahedronNodes X = NodesOfHexahedron(mesh, h);
    for (int q = 0; q < 8; ++q) {
      Vec3 at;
      for (int d = 0; d < 3; ++d) at[d] = (q >> d & 1) != 0 ? 1 - kNear : kNear;
      const Mat3 slopes = TrilinearSlopes(X, at);
      if (slopes.col(0).cross(slopes.col(1)).dot(slopes.col(2)) > 0) continue;
      folded.Add(h);
      break;
    }
  }
  if (mesh.tetrahedra.size() != first.back()) {
    problems.Add("", std::to_string(mesh.tetrahedra.size()) + " tetrahedra for " +
                         std::to_string(mesh.hexahedra.size()) + " hexahedra, not " + std::to_string(first.back()));
  }
  collapsed.Report("hexahedron has repeated nodes, but is neither a wedge nor a pyramid",
                   "hexahedra have repeated nodes, but are neither wedges nor pyramids",
                   "a wedge is 0 1 2 2 3 4 5 5, a pyramid 0 1 2 3 4 4 4 4", problems);
  wrong.Report("hexahedron has other nodes than its tetrahedra", "hexahedra have other nodes than their tetrahedra",
               "split them again", problems);
  folded.Report("hexahedron is inverted or folded", "hexahedra are inverted or folded",
                "order their nodes around the lower side, then around the upper one, or mesh the body again", problems);
}

}  // namespace

MeshReport CheckMesh(const TetMesh& mesh, Problems& problems, const std::stop_token& stop) {
  MeshReport report;
  MeasureBox(mesh, report);
  CheckNotEmpty(mesh, problems);
  CheckCoordinates(mesh, problems);
  CheckSize(report, problems);
  CheckCoincidentNodes(mesh, report, stop, problems);
  const std::size_t before = problems.count();
  CheckIndices(mesh, problems);
  if (problems.count() > before) return report;  // the checks below use the indices
  CheckVolumes(mesh, stop, problems);
  CheckDuplicates(mesh, stop, problems);
  CheckUnusedNodes(mesh, stop, problems);
  CheckCurvedEdges(mesh, stop, problems);
  CheckHexahedra(mesh, stop, problems);
  report.components = CheckComponents(mesh, stop, problems);
  report.volume = TotalVolume(mesh);
  report.smallest_dihedral_angle = SmallestDihedralAngle(mesh, stop);
  return report;
}

void CheckMadeMesh(const TetMesh& mesh, Problems& problems, const std::stop_token& stop) {
  MeshReport report;
  MeasureBox(mesh, report);
  CheckCoordinates(mesh, problems);
  CheckSize(report, problems);
  CheckCoincidentNodes(mesh, report, stop, problems);
  CheckVolumes(mesh, stop, problems);
  CheckHexahedra(mesh, stop, problems);
}

bool OrientConsistently(TetMesh& mesh) {
  if (mesh.tetrahedra.empty()) return false;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    if (!InRange(mesh.tetrahedra[t], mesh.nodes.size()) || !(SignedVolume(mesh, t) < 0)) return false;
  }
  for (Tetrahedron& tetrahedron : mesh.tetrahedra) std::swap(tetrahedron[2], tetrahedron[3]);
  for (Hexahedron& hexahedron : mesh.hexahedra) TurnOver(hexahedron);
  return true;
}

}  // namespace fascicle
