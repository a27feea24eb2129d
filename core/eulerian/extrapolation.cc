#include "core/eulerian/extrapolation.h"

#include <Eigen/Cholesky>

namespace fascicle {
namespace {

constexpr int kReach = 2;        // [cells] along each axis
constexpr int kSquareReach = 6;  // [cells^2]: at a cube's corner four nodes inside that are not in a plane
constexpr double kHair = 1e-6;   // of the weights, against slopes that nothing tells

// Calls body(number, offset) for the nodes of the grid within `reach` of one.
template <class Body>
void ForNeighbours(const EulerianGrid& grid, const GridIndex& at, int reach, const Body& body) {
  for (int k = -reach; k <= reach; ++k) {
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        if (i * i + j * j + k * k > kSquareReach) continue;
        const GridIndex other = {at[0] + i, at[1] + j, at[2] + k};
        if (grid.HasNode(other)) body(grid.NodeNumber(other), Vec3(i, j, k));
      }
    }
  }
}

// The value there of the linear function that fits the field less slope times the position: what ExtrapolationWeights
// weighs, without the weights.
Vec3 Fitted(const EulerianGrid& grid, const GridIndex& at, double slope, const std::vector<std::uint8_t>& known,
            const std::vector<Vec3>& field) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> b = Eigen::Matrix<double, 4, 3>::Zero();
  const Vec3 x = grid.NodePosition(at);
  ForNeighbours(grid, at, kReach, [&](std::size_t number, const Vec3& offset) {
    if (known[number] == 0) return;
    const Eigen::Vector4d row(1, offset[0], offset[1], offset[2]);
    const Eigen::Vector4d weighted = row / std::max(offset.squaredNorm(), 0.25);
    A += weighted * row.transpose();
    b += weighted * (field[number] - slope * (x + grid.spacing * offset)).transpose();
  });
  const double total = A(0, 0);
  for (int axis = 1; axis < 4; ++axis) A(axis, axis) += kHair * total;
  const Eigen::Vector4d value = A.ldlt().solve(Eigen::Vector4d::Unit(0));
  return slope * x + b.transpose() * value;
}

}  // namespace

std::vector<NodeWeight> ExtrapolationWeights(const EulerianGrid& grid, const GridIndex& at,
                                             const std::vector<std::uint8_t>& known) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  std::vector<NodeWeight> weights;
  std::vector<Eigen::Vector4d> rows;
  double total = 0;
  ForNeighbours(grid, at, kReach, [&](std::size_t number, const Vec3& offset) {
    if (known[number] == 0) return;
    const double weight = 1 / std::max(offset.squaredNorm(), 0.25);
    const Eigen::Vector4d row(1, offset[0], offset[1], offset[2]);
    A += weight * row * row.transpose();
    total += weight;
    weights.push_back({number, weight});
    rows.push_back(row);
  });
  if (weights.empty()) return weights;
  for (int axis = 1; axis < 4; ++axis) A(axis, axis) += kHair * total;
  const Eigen::Vector4d value = A.ldlt().solve(Eigen::Vector4d::Unit(0));
  for (std::size_t k = 0; k < weights.size(); ++k) weights[k].weight *= value.dot(rows[k]);
  return weights;
}

void Extrapolate(const EulerianGrid& grid, int layers, double slope, ThreadTeam& team, std::vector<std::uint8_t>& known,
                 std::vector<Vec3>& field) {
  std::vector<std::size_t> front, next;
  for (std::size_t n = 0; n < known.size(); ++n) {
    if (known[n] != 0) front.push_back(n);
  }
  for (int layer = 0; layer < layers; ++layer) {
    next.clear();
    for (const std::size_t n : front) {
      ForNeighbours(grid, grid.NodeAt(n), 1, [&](std::size_t number, const Vec3&) {
        if (known[number] != 0) return;
        known[number] = 1;  // so that it is found once; not yet known
        next.push_back(number);
      });
    }
    for (const std::size_t n : next) known[n] = 0;
    team.For(next.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        field[next[k]] = Fitted(grid, grid.NodeAt(next[k]), slope, known, field);
      }
    });
    for (const std::size_t n : next) known[n] = 1;
    std::swap(front, next);
  }
}

}  // namespace fascicle
