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

// The slope at a node of the linear function that fits the known values around it best, as columns by axes, per cell.
// value(number, offset): what is fitted. Directions in which known nodes lie flat get none.
template <class Value>
Mat3 SlopeAt(const EulerianGrid& grid, const GridIndex& at, const std::vector<std::uint8_t>& known,
             const Value& value) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> b = Eigen::Matrix<double, 4, 3>::Zero();
  ForNeighbours(grid, at, kReach, [&](std::size_t number, const Vec3& offset) {
    if (known[number] == 0) return;
    const Eigen::Vector4d row(1, offset[0], offset[1], offset[2]);
    const Eigen::Vector4d weighted = row / std::max(offset.squaredNorm(), 0.25);
    A += weighted * row.transpose();
    b += weighted * value(number, offset).transpose();
  });
  const double total = A(0, 0);
  for (int axis = 1; axis < 4; ++axis) A(axis, axis) += kHair * total;
  return A.ldlt().solve(b).bottomRows<3>().transpose();
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
  const auto is_unknown = [&](std::size_t n) { return known[n] == 0; };
  // Known nodes beside unknown ones, with the slope of the field less `slope` times the position there.
  std::vector<std::size_t> front, next;
  std::vector<std::uint8_t> is_front(known.size(), 0);
  team.For(known.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      if (known[n] == 0) continue;
      ForNeighbours(grid, grid.NodeAt(n), 1, [&](std::size_t other, const Vec3&) { is_front[n] |= is_unknown(other); });
    }
  });
  for (std::size_t n = 0; n < known.size(); ++n) {
    if (is_front[n] != 0) front.push_back(n);
  }
  std::vector<Mat3> slopes(known.size());
  team.For(front.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      slopes[front[k]] = SlopeAt(grid, grid.NodeAt(front[k]), known, [&](std::size_t number, const Vec3& offset) {
        return Vec3(field[number] - slope * grid.spacing * offset);
      });
    }
  });
  for (int layer = 0; layer < layers; ++layer) {
    next.clear();
    for (const std::size_t n : front) {
      ForNeighbours(grid, grid.NodeAt(n), 1, [&](std::size_t number, const Vec3&) {
        if (!is_unknown(number)) return;
        known[number] = 1;  // so that it is found once; not yet known
        next.push_back(number);
      });
    }
    for (const std::size_t n : next) known[n] = 0;
    team.For(next.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        Vec3 value = Vec3::Zero();
        Mat3 mean = Mat3::Zero();
        double total = 0;
        ForNeighbours(grid, grid.NodeAt(next[k]), 1, [&](std::size_t number, const Vec3& offset) {
          if (is_unknown(number)) return;
          const double weight = 1 / offset.squaredNorm();
          value += weight * (field[number] - slopes[number] * offset - slope * grid.spacing * offset);
          mean += weight * slopes[number];
          total += weight;
        });
        field[next[k]] = value / total;
        slopes[next[k]] = mean / total;
      }
    });
    for (const std::size_t n : next) known[n] = 1;
    std::swap(front, next);
  }
}

}  // namespace fascicle
