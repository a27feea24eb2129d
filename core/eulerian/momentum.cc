#include "core/eulerian/momentum.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>

namespace fascicle {
namespace {

// The sum of add(n, sum) over all nodes with mass, block by block: the same bits for any number of threads.
template <int kSize, class Add>
Eigen::Vector<double, kSize> SumOverNodes(const NodalForces& nodes, ThreadTeam& team, const Add& add) {
  using Sum = Eigen::Vector<double, kSize>;
  constexpr std::size_t kBlock = 4096;
  const std::size_t count = nodes.mass.size();
  std::vector<Sum> parts((count + kBlock - 1) / kBlock, Sum::Zero());
  team.For(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      for (std::size_t n = b * kBlock; n < std::min(count, (b + 1) * kBlock); ++n) {
        if (nodes.mass[n] != 0) add(n, parts[b]);
      }
    }
  });
  Sum sum = Sum::Zero();
  for (const Sum& part : parts) sum += part;
  return sum;
}

// value(n): the quantity at node n.
template <class Value>
Resultant ResultantOf(const EulerianGrid& grid, const NodalForces& nodes, ThreadTeam& team, const Value& value) {
  const Eigen::Vector<double, 6> sum = SumOverNodes<6>(nodes, team, [&](std::size_t n, Eigen::Vector<double, 6>& sums) {
    const Vec3 own = value(n);
    sums.head<3>() += own;
    sums.tail<3>() += grid.NodePosition(grid.NodeAt(n)).cross(own);
  });
  return {.sum = sum.head<3>(), .moment = sum.tail<3>()};
}

}  // namespace

double MassOf(const NodalForces& nodes, ThreadTeam& team) {
  return team.Sum(nodes.mass.size(), [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t n = begin; n < end; ++n) sum += nodes.mass[n];
    return sum;
  });
}

Resultant MomentumOf(const EulerianGrid& grid, const NodalForces& nodes, const std::vector<Vec3>& v, ThreadTeam& team) {
  return ResultantOf(grid, nodes, team, [&](std::size_t n) { return Vec3(nodes.mass[n] * v[n]); });
}

Resultant ForceOf(const EulerianGrid& grid, const NodalForces& nodes, ThreadTeam& team) {
  return ResultantOf(grid, nodes, team, [&](std::size_t n) { return nodes.force[n]; });
}

RigidVelocity RigidVelocityOf(const EulerianGrid& grid, const NodalForces& nodes, const Resultant& momentum,
                              ThreadTeam& team) {
  const auto place = [&](std::size_t n) { return grid.NodePosition(grid.NodeAt(n)); };
  const auto masses = SumOverNodes<4>(
      nodes, team, [&](std::size_t n, Eigen::Vector4d& sums) { sums += nodes.mass[n] * place(n).homogeneous(); });
  const double mass = masses[3];
  const Vec3 centre = masses.head<3>() / mass;
  const auto inertia = SumOverNodes<9>(nodes, team, [&](std::size_t n, Eigen::Vector<double, 9>& sums) {
    const Vec3 x = place(n) - centre;
    sums += nodes.mass[n] * (x.squaredNorm() * Mat3::Identity() - x * x.transpose()).reshaped();
  });
  const Vec3 spin = Mat3(inertia.reshaped(3, 3)).ldlt().solve(momentum.moment - centre.cross(momentum.sum));
  return {centre, momentum.sum / mass, spin};
}

RigidVelocity RigidPartOf(const EulerianGrid& grid, const NodalForces& nodes, const std::vector<Vec3>& v,
                          ThreadTeam& team) {
  return RigidVelocityOf(grid, nodes, MomentumOf(grid, nodes, v, team), team);
}

void SetMomentum(const EulerianGrid& grid, const NodalForces& nodes, const Resultant& wanted,
                 const std::vector<std::uint8_t>& known, ThreadTeam& team, std::vector<Vec3>& v) {
  const Resultant present = MomentumOf(grid, nodes, v, team);
  const RigidVelocity missing =
      RigidVelocityOf(grid, nodes, {wanted.sum - present.sum, wanted.moment - present.moment}, team);
  team.For(v.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      if (known[n] != 0) v[n] += missing.At(grid.NodePosition(grid.NodeAt(n)));
    }
  });
}

}  // namespace fascicle
