#include "core/eulerian/surface.h"

#include <Eigen/LU>

#include <limits>

#include "core/eulerian/interpolation.h"

namespace fascicle {
namespace {

constexpr int kMostIterations = 20;
constexpr double kEnough = 1e-8;  // of a cell

// dX/dx at a point by differences over half a cell each way.
std::optional<Mat3> MapGradient(const EulerianGrid& grid, const KnownField& X, const Vec3& x) {
  const double step = 0.25 * grid.spacing;
  Mat3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<Vec3> ahead = Interpolate(grid, X, x + step * Vec3::Unit(axis));
    const std::optional<Vec3> behind = Interpolate(grid, X, x - step * Vec3::Unit(axis));
    if (!ahead || !behind) return std::nullopt;
    gradient.col(axis) = (*ahead - *behind) / (2 * step);
  }
  return gradient;
}

double Carry(const EulerianGrid& grid, const KnownField& X, const Vec3& X_v, Vec3& x) {
  double left = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kMostIterations; ++k) {
    const std::optional<Vec3> here = Interpolate(grid, X, x);
    const std::optional<Mat3> gradient = MapGradient(grid, X, x);
    if (!here || !gradient) return std::numeric_limits<double>::infinity();
    left = (X_v - *here).norm();
    if (left < kEnough * grid.spacing) break;
    x += gradient->partialPivLu().solve(X_v - *here);
  }
  return left;
}

}  // namespace

double CarrySurface(const EulerianBody& body, const EulerianState& state, ThreadTeam& team,
                    std::vector<Vec3>& vertices) {
  const KnownField X = {&state.X, &state.known};
  std::vector<double> left(vertices.size());
  team.For(vertices.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) left[v] = Carry(body.grid, X, body.shape.surface().nodes[v], vertices[v]);
  });
  return left.empty() ? 0 : *std::max_element(left.begin(), left.end());
}

}  // namespace fascicle
