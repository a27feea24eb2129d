#include "core/eulerian/momentum.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace fascicle {

double MassOf(const NodalForces& nodes) {
  double sum = 0;
  for (const double mass : nodes.mass) sum += mass;
  return sum;
}

Resultant MomentumOf(const EulerianGrid& grid, const NodalForces& nodes, const std::vector<Vec3>& v) {
  Resultant result;
  for (std::size_t n = 0; n < v.size(); ++n) {
    if (nodes.mass[n] == 0) continue;
    const Vec3 p = nodes.mass[n] * v[n];
    result.sum += p;
    result.moment += grid.NodePosition(grid.NodeAt(n)).cross(p);
  }
  return result;
}

Resultant ForceOf(const EulerianGrid& grid, const NodalForces& nodes) {
  Resultant result;
  for (std::size_t n = 0; n < nodes.mass.size(); ++n) {
    if (nodes.mass[n] == 0) continue;
    result.sum += nodes.force[n];
    result.moment += grid.NodePosition(grid.NodeAt(n)).cross(nodes.force[n]);
  }
  return result;
}

void SetMomentum(const EulerianGrid& grid, const NodalForces& nodes, const Resultant& wanted,
                 const std::vector<std::uint8_t>& known, std::vector<Vec3>& v) {
  const Resultant present = MomentumOf(grid, nodes, v);
  double mass = 0;
  Vec3 centre = Vec3::Zero();
  for (std::size_t n = 0; n < v.size(); ++n) {
    mass += nodes.mass[n];
    centre += nodes.mass[n] * grid.NodePosition(grid.NodeAt(n));
  }
  centre /= mass;
  Mat3 inertia = Mat3::Zero();
  for (std::size_t n = 0; n < v.size(); ++n) {
    if (nodes.mass[n] == 0) continue;
    const Vec3 x = grid.NodePosition(grid.NodeAt(n)) - centre;
    inertia += nodes.mass[n] * (x.squaredNorm() * Mat3::Identity() - x * x.transpose());
  }
  const Vec3 missing = wanted.sum - present.sum;
  const Vec3 spin = inertia.ldlt().solve(wanted.moment - present.moment - centre.cross(missing));
  for (std::size_t n = 0; n < v.size(); ++n) {
    if (known[n] != 0) v[n] += missing / mass + spin.cross(grid.NodePosition(grid.NodeAt(n)) - centre);
  }
}

}  // namespace fascicle
