#include "core/eulerian/solid_shape.h"

#include <map>
#include <string>

#include "core/geometry/surface_repair.h"
#include "core/geometry/triangle_tree.h"

namespace fascicle {
namespace {

constexpr double kMargin = 2;      // number of samples around the surface's bounding box
constexpr double kLeastCells = 4;  // across

// Number of edges that do not have one triangle on each side.
std::size_t OpenEdges(const TriangleMesh& surface) {
  std::map<std::array<std::int32_t, 2>, int> sides;
  for (const auto& triangle : surface.triangles) {
    for (int e = 0; e < 3; ++e) {
      const std::int32_t a = triangle[e], b = triangle[(e + 1) % 3];
      a < b ? ++sides[{a, b}] : --sides[{b, a}];
    }
  }
  return static_cast<std::size_t>(
      std::count_if(sides.begin(), sides.end(), [](const auto& s) { return s.second != 0; }));
}

}  // namespace

SolidShape::SolidShape(TriangleMesh surface, double spacing, ThreadTeam& team)
    : surface_(std::move(surface)), bounds_(BoundsOf(surface_.nodes)), volume_(EnclosedVolume(surface_)) {
  samples_ = MaterialGrid(spacing);
  const TriangleTree tree(surface_);
  distance_.resize(samples_.node_count());
  team.For(distance_.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      distance_[n] = tree.SignedDistance(samples_.NodePosition(samples_.NodeAt(n)));
  });
}

EulerianGrid SolidShape::MaterialGrid(double spacing) const {
  EulerianGrid grid;
  grid.spacing = spacing;
  grid.origin = bounds_.lowest - Vec3::Constant(kMargin * spacing);
  for (int axis = 0; axis < 3; ++axis) {
    grid.cells[axis] = static_cast<std::int32_t>(std::ceil(bounds_.extent()[axis] / spacing + 2 * kMargin));
  }
  return grid;
}

double SolidShape::Distance(const Vec3& X) const {
  const EulerianGrid::Place place = samples_.PlaceOf(X);
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    sum += CornerWeight(c, place.within) * distance_[samples_.Corner(place.cell, c)];
  }
  const Vec3 nearest = samples_.NodePosition(place.cell) + samples_.spacing * place.within;
  return sum + (X - nearest).norm();
}

void CheckSolidSurface(const TriangleMesh& surface, double spacing, Problems& problems) {
  if (surface.triangles.empty()) {
    problems.Add("", "the surface has no triangles", "give a closed surface");
    return;
  }
  const std::size_t open = OpenEdges(surface);
  if (open > 0) {
    problems.Add("",
                 std::to_string(open) +
                     " edges of the surface lack a triangle on one side, or have one with the wrong orientation",
                 "close it; `fascicle mesh` repairs small holes");
    return;
  }
  if (EnclosedVolume(surface) <= 0) {
    problems.Add("", "the surface is inverted", "triangles are counter-clockwise seen from outside");
    return;
  }
  // A cavity whose surface is outward would count as a second body in the same place.
  TriangleMesh oriented = surface;
  Problems ignored;
  if (RepairSurface(oriented, 0, ignored).turned_triangles > 0) {
    problems.Add("", "a part of the surface has the wrong orientation",
                 "triangles are counter-clockwise seen from outside of the body, also those of a cavity");
    return;
  }
  const std::size_t cuts = TriangleTree(surface).CuttingPairs().size();
  if (cuts > 0) {
    problems.Add("", "the surface intersects itself at " + std::to_string(cuts) + " pairs of triangles",
                 "repair it first");
  }
  const double across = BoundsOf(surface.nodes).extent().minCoeff() / spacing;
  if (across < kLeastCells) {
    problems.Add("", "the solid is " + std::to_string(across) + " cells across; at least 4 are needed",
                 "use smaller cells");
  }
}

}  // namespace fascicle
