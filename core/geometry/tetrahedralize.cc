#include "core/geometry/tetrahedralize.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/geometry/isosurface_stuffing.h"
#include "core/geometry/mesh_improvement.h"
#include "core/geometry/octree_lattice.h"
#include "core/geometry/triangle_tree.h"
#include "core/geometry/unused_nodes.h"

namespace fascicle {
namespace {

constexpr double kLargestHole = 0.1;  // relative to the diagonal
constexpr double kMostTetrahedra = 5e7;
constexpr int kSizeRounds = 5;
constexpr double kCountTolerance = 0.05;
constexpr int kSweeps = 8;
constexpr double kOwnPart = 0.01;       // relative to the volume: smaller parts are left out
constexpr double kCutTolerance = 0.01;  // relative to the volume, for surfaces that intersect themselves

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return text;
}

class Meshing {
 public:
  Meshing(TriangleMesh& surface, const MeshingOptions& options, ThreadTeam& team, Problems& problems,
          const MeshingProgress& progress)
      : surface_(surface), options_(options), team_(team), problems_(problems), progress_(progress) {}

  std::optional<MeshingResult> Run() {
    Tell(0, "repairing the surface");
    DropUnusedNodes(surface_.nodes, surface_.triangles);  // they may be anywhere
    const double diagonal = Diagonal(surface_.nodes);
    const double hole = options_.largest_hole < 0 ? kLargestHole * diagonal : options_.largest_hole;
    const std::size_t before = problems_.count();
    report_.surface = RepairSurface(surface_, hole, problems_, team_.stop());
    if (problems_.count() > before) return std::nullopt;
    report_.surface_volume = EnclosedVolume(surface_);
    if (!(report_.surface_volume > 1e-9 * diagonal * diagonal * diagonal)) {
      problems_.Add("", "the surface encloses no volume", "is it a sheet?");
      return std::nullopt;
    }
    const TriangleTree tree(surface_);
    if (!Stuff(tree) || !KeepLargestPart()) return std::nullopt;
    Tell(0.4, "improving angles");
    ImproveAngles(mesh_, tree, kSweeps, team_);
    Tell(0.7, "fitting the volume");
    if (!Fit(tree)) return std::nullopt;
    Tell(0.9, "measuring");
    Measure(tree);
    Tell(1, "done");
    return MeshingResult{std::move(mesh_), std::move(report_)};
  }

 private:
  void Tell(double part, const char* what) const {
    if (progress_) progress_(part, what);
    team_.ThrowIfStopped();
  }

  double CountAt(double size) const { return 12 * report_.surface_volume / (size * size * size); }

  // Stuffs the surface at the given size, or at sizes that approach the wanted number of tetrahedra.
  bool Stuff(const TriangleTree& tree) {
    double size = options_.size;
    if (size > 0 && CountAt(size) > kMostTetrahedra) {
      problems_.Add("size",
                    "tetrahedra of size " + Number(size) + " would be about " + Number(CountAt(size)) + " in number",
                    "the smallest size for this surface is about " +
                        Number(size * std::cbrt(CountAt(size) / kMostTetrahedra)) + "; is the unit right?");
      return false;
    }
    const auto wanted = static_cast<double>(options_.tetrahedra);
    if (size <= 0) size = std::cbrt(12 * report_.surface_volume / wanted);
    double least_error = 0;
    for (int round = 0; round < kSizeRounds; ++round) {
      Tell(0.05 + 0.06 * round, "filling with a lattice");
      TetMesh mesh = StuffLattice(MakeLattice(surface_, tree, size, options_.grading, team_), tree, team_);
      const auto count = static_cast<double>(mesh.tetrahedra.size());
      const double error = options_.size > 0 ? 0 : std::abs(count / wanted - 1);
      if (round == 0 || error < least_error) {
        mesh_ = std::move(mesh);
        report_.size = size;
        least_error = error;
      }
      if (error < kCountTolerance) break;
      size *= count > 0 ? std::clamp(std::cbrt(count / wanted), 0.5, 2.0) : 0.5;
    }
    if (!mesh_.tetrahedra.empty()) return true;
    problems_.Add("size", "the size of " + Number(report_.size) + " is too large for this surface: no tetrahedron fits",
                  "try a tenth of it");
    return false;
  }

  // Drops negligible parts; refuses several bodies.
  bool KeepLargestPart() {
    const std::vector<std::int32_t> part = FaceConnectedParts(mesh_, team_.stop());
    const std::int32_t parts = *std::max_element(part.begin(), part.end()) + 1;
    if (parts == 1) return true;
    std::vector<double> volume(parts);
    std::vector<Vec3> centre(parts, Vec3::Zero());
    for (std::size_t t = 0; t < part.size(); ++t) {
      volume[part[t]] += SignedVolume(mesh_, t);
      centre[part[t]] += SignedVolume(mesh_, t) * Centroid(mesh_, t);
    }
    const auto largest = static_cast<std::int32_t>(std::max_element(volume.begin(), volume.end()) - volume.begin());
    std::string others;
    for (std::int32_t p = 0; p < parts; ++p) {
      if (p != largest) report_.lost_volume += volume[p];
      if (p == largest || volume[p] < kOwnPart * report_.surface_volume) continue;
      SurfacePlace place;
      place.centre = centre[p] / volume[p];
      place.extent = std::cbrt(volume[p]);
      others += (others.empty() ? "" : "; ") + PlaceText(place);
    }
    if (!others.empty()) {
      problems_.Add("", "the surface encloses more than one body: beside the largest there is one at " + others,
                    report_.surface.parts > 1
                        ? "mesh each body by itself"
                        : "the surface is thinner than the mesh between them: use a smaller size");
      return false;
    }
    std::size_t t = 0;
    std::erase_if(mesh_.tetrahedra, [&](const Tetrahedron&) { return part[t++] != largest; });
    DropUnusedNodes(mesh_.nodes, mesh_.tetrahedra);
    return true;
  }

  // The true volume of a self-intersecting surface is not known beforehand.
  bool Fit(const TriangleTree& tree) {
    const std::vector<SurfacePlace>& cuts = report_.surface.cuts;
    std::optional<double> volume;
    if (cuts.empty()) volume = report_.surface_volume - report_.lost_volume;
    FitSurface(mesh_, tree, volume, team_);
    const double error = TotalVolume(mesh_) / report_.surface_volume - 1;
    if (cuts.empty() || std::abs(error) <= kCutTolerance) return true;
    for (const SurfacePlace& place : cuts) {
      problems_.Add("",
                    "the surface intersects itself at " + PlaceText(place) + ", in " + std::to_string(place.count) +
                        " pairs of triangles",
                    "the volume inside, counted once, differs by " + Number(100 * std::abs(error)) +
                        " % from the enclosed volume, which counts overlaps twice: separate the parts there");
    }
    return false;
  }

  void Measure(const TriangleTree& tree) {
    report_.angles = MeasureAngles(mesh_, team_.stop());
    report_.volume = TotalVolume(mesh_);
    TriangleMesh outside;
    outside.nodes = mesh_.nodes;
    outside.triangles = BoundaryTriangles(mesh_, team_.stop());
    std::vector<Vec3> points;
    for (const Triangle& t : outside.triangles) {
      points.push_back((mesh_.nodes[t[0]] + mesh_.nodes[t[1]] + mesh_.nodes[t[2]]) / 3);
      for (const std::int32_t n : t) points.push_back(mesh_.nodes[n]);
    }
    KeepFurthest(points, tree);
    KeepFurthest(surface_.nodes, TriangleTree(outside));
  }

  void KeepFurthest(const std::vector<Vec3>& points, const TriangleTree& tree) {
    std::vector<double> distance(points.size());
    ForEach(team_, points.size(), 64, [&](std::size_t i) { distance[i] = tree.Distance(points[i]); });
    const auto furthest = std::max_element(distance.begin(), distance.end());
    if (*furthest < report_.surface_distance) return;
    report_.surface_distance = *furthest;
    report_.furthest = points[static_cast<std::size_t>(furthest - distance.begin())];
  }

  TriangleMesh& surface_;
  const MeshingOptions& options_;
  ThreadTeam& team_;
  Problems& problems_;
  const MeshingProgress& progress_;
  TetMesh mesh_;
  MeshingReport report_;
};

}  // namespace

std::optional<MeshingResult> Tetrahedralize(TriangleMesh& surface, const MeshingOptions& options, ThreadTeam& team,
                                            Problems& problems, const MeshingProgress& progress) {
  return Meshing(surface, options, team, problems, progress).Run();
}

}  // namespace fascicle
