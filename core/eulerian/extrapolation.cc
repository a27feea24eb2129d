#include "core/eulerian/extrapolation.h"

#include <Eigen/Cholesky>

namespace fascicle {
namespace {

constexpr int kReach = 2;       // [cells]
constexpr double kHair = 1e-6;  // of the weights, against slopes that nothing tells

// Calls body(number, offset) for the nodes of the grid within `reach` of one.
template <class Body>
void ForNeighbours(const EulerianGrid& grid, const GridIndex& at, int reach, const Body& body) {
  for (int k = -reach; k <= reach; ++k) {
    for (int j = -reach; j <= reach; ++j) {
      for (int i = -reach; i <= reach; ++i) {
        const GridIndex other = {at[0] + i, at[1] + j, at[2] + k};
        if (grid.HasNode(other)) body(grid.NodeNumber(other), Vec3(i, j, k));
      }
    }
  }
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
  std::vector<std::uint8_t> next = known;
  for (int layer = 0; layer < layers; ++layer) {
    team.For(known.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        if (known[n] != 0) continue;
        const GridIndex at = grid.NodeAt(n);
        bool touches = false;
        ForNeighbours(grid, at, 1, [&](std::size_t number, const Vec3&) { touches |= known[number] != 0; });
        if (!touches) continue;
        const Vec3 x = grid.NodePosition(at);
        Vec3 sum = slope * x;
        for (const NodeWeight& part : ExtrapolationWeights(grid, at, known)) {
          sum += part.weight * (field[part.node] - slope * grid.NodePosition(grid.NodeAt(part.node)));
        }
        field[n] = sum;
        next[n] = 1;
      }
    });
    known = next;
  }
}

}  // namespace fascicle
