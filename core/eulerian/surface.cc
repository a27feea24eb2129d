#include "core/eulerian/surface.h"

#include <Eigen/LU>

#include <limits>

namespace fascicle {
namespace {

constexpr int kMostIterations = 20;
constexpr double kEnough = 1e-8;  // relative to a cell

}  // namespace

double FindPoint(const EulerianGrid& grid, const KnownField& map, const Vec3& X, Vec3& place) {
  double left = std::numeric_limits<double>::infinity();
  Vec3 x = place;
  for (int k = 0; k < kMostIterations; ++k) {
    const std::optional<ValueAndGradient> here = InterpolateWithGradient(grid, map, x);
    if (!here) return std::numeric_limits<double>::infinity();
    left = (X - here->value).norm();
    if (left < kEnough * grid.spacing) break;
    x += here->gradient.partialPivLu().solve(X - here->value);
  }
  place = x;
  return left;
}

double FindSurface(const EulerianBody& body, ThreadTeam& team, EulerianState& state) {
  const KnownField map = {&state.X, &state.known};
  const std::vector<Vec3>& X = body.shape.surface().nodes;
  std::vector<double> left(X.size());
  team.For(X.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) left[v] = FindPoint(body.grid, map, X[v], state.surface[v]);
  });
  return left.empty() ? 0 : *std::max_element(left.begin(), left.end());
}

std::vector<Vec3> SurfaceInWorld(const EulerianBody& body, const EulerianState& state) {
  const GridFrame frame(state.pose, body.travels);
  std::vector<Vec3> places;
  for (const Vec3& y : state.surface) places.push_back(frame.PointInWorld(y));
  return places;
}

double SurfaceVolume(const EulerianBody& body, const EulerianState& state) {
  return EnclosedVolume({state.surface, body.shape.surface().triangles});
}

}  // namespace fascicle
