#include "core/eulerian/extrapolation.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <atomic>

namespace fascicle {
namespace {

constexpr int kSlopeReach = 2;            // [cells] along each axis
constexpr int kSquareReach = 6;           // [cells^2]; includes four non-coplanar interior nodes at a cube's corner
constexpr double kRegularization = 1e-6;  // relative to the weights, for slopes that known nodes do not determine

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

// The slope at a node of the linear function that best fits the known values around it: one column per axis, per cell.
// value(number, offset): the value to fit. Directions in which the known nodes are coplanar have slope zero.
template <class IsKnown, class Value>
Mat3 SlopeAt(const EulerianGrid& grid, const GridIndex& at, const IsKnown& is_known, const Value& value) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> b = Eigen::Matrix<double, 4, 3>::Zero();
  ForNeighbours(grid, at, kSlopeReach, [&](std::size_t number, const Vec3& offset) {
    if (!is_known(number)) return;
    const Eigen::Vector4d row(1, offset[0], offset[1], offset[2]);
    const Eigen::Vector4d weighted = row / std::max(offset.squaredNorm(), 0.25);
    A += weighted * row.transpose();
    b += weighted * value(number, offset).transpose();
  });
  const double total = A(0, 0);
  for (int axis = 1; axis < 4; ++axis) A(axis, axis) += kRegularization * total;
  return A.ldlt().solve(b).bottomRows<3>().transpose();
}

// Collects the results of find(k, found) for each k below `count`, in the order of k.
template <class Find>
std::vector<std::size_t> Gather(std::size_t count, ThreadTeam& team, const Find& find) {
  constexpr std::size_t kBlock = 512;
  std::vector<std::vector<std::size_t>> found((count + kBlock - 1) / kBlock);
  team.For(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      for (std::size_t k = b * kBlock; k < std::min(count, (b + 1) * kBlock); ++k) find(k, found[b]);
    }
  });
  std::vector<std::size_t> all;
  for (const std::vector<std::size_t>& part : found) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace

std::vector<NodeWeight> ExtrapolationWeights(const EulerianGrid& grid, const GridIndex& at,
                                             const std::vector<std::uint8_t>& known) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  std::vector<NodeWeight> weights;
  std::vector<Eigen::Vector4d> rows;
  double total = 0;
  ForNeighbours(grid, at, kSlopeReach, [&](std::size_t number, const Vec3& offset) {
    if (known[number] == 0) return;
    const double weight = 1 / std::max(offset.squaredNorm(), 0.25);
    const Eigen::Vector4d row(1, offset[0], offset[1], offset[2]);
    A += weight * row * row.transpose();
    total += weight;
    weights.push_back({number, weight});
    rows.push_back(row);
  });
  if (weights.empty()) return weights;
  for (int axis = 1; axis < 4; ++axis) A(axis, axis) += kRegularization * total;
  const Eigen::Vector4d value = A.ldlt().solve(Eigen::Vector4d::Unit(0));
  for (std::size_t k = 0; k < weights.size(); ++k) weights[k].weight *= value.dot(rows[k]);
  return weights;
}

Band::Band(const EulerianGrid& grid, const std::vector<std::uint8_t>& known, int layers, ThreadTeam& team)
    : grid_(&grid), layer_(known) {
  places_.push_back(Front(team));
  for (int layer = 1; layer <= layers; ++layer) places_.push_back(Beside(places_.back(), layer, team));
  number_of_.resize(layer_.size());
  int count = 0;
  for (const Places& places : places_) {
    for (const std::size_t n : places) number_of_[n] = count++;
  }
}

std::vector<std::uint8_t> Band::Known(int layers) const {
  std::vector<std::uint8_t> known(layer_.size());
  for (std::size_t n = 0; n < known.size(); ++n) known[n] = layer_[n] != 0 && layer_[n] <= 1 + layers ? 1 : 0;
  return known;
}

// The known nodes with unknown neighbours.
Band::Places Band::Front(ThreadTeam& team) const {
  return Gather(layer_.size(), team, [&](std::size_t n, Places& found) {
    if (layer_[n] == 0) return;
    bool is_front = false;
    ForNeighbours(*grid_, grid_->NodeAt(n), 1, [&](std::size_t other, const Vec3&) { is_front |= layer_[other] == 0; });
    if (is_front) found.push_back(n);
  });
}

// Nodes without a layer next to those of the previous layer. Threads race to claim nodes; results do not depend on the
// order.
Band::Places Band::Beside(const Places& before, int layer, ThreadTeam& team) {
  return Gather(before.size(), team, [&](std::size_t k, Places& found) {
    ForNeighbours(*grid_, grid_->NodeAt(before[k]), 1, [&](std::size_t other, const Vec3&) {
      const std::atomic_ref<std::uint8_t> place(layer_[other]);
      std::uint8_t none = 0;
      const bool is_first =
          place.load(std::memory_order_relaxed) == 0 &&
          place.compare_exchange_strong(none, static_cast<std::uint8_t>(1 + layer), std::memory_order_relaxed);
      if (is_first) found.push_back(other);
    });
  });
}

void Band::Extend(int layers, double slope, ThreadTeam& team, std::vector<Vec3>& field) const {
  // Without the term `slope` times the position.
  std::vector<Mat3> slopes(NodeCount(layers));
  const Places& front = places_.front();
  const double own = slope * grid_->spacing;
  team.For(front.size(), 64, [&](std::size_t begin, std::size_t end) {
    const auto is_known = [&](std::size_t n) { return layer_[n] == 1; };
    for (std::size_t k = begin; k < end; ++k) {
      slopes[k] = SlopeAt(*grid_, grid_->NodeAt(front[k]), is_known,
                          [&](std::size_t number, const Vec3& offset) { return Vec3(field[number] - own * offset); });
    }
  });
  for (int layer = 1; layer <= layers; ++layer) {
    const Places& places = places_[layer];
    team.For(places.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        Vec3 value = Vec3::Zero();
        Mat3 mean = Mat3::Zero();
        double total = 0;
        ForNeighbours(*grid_, grid_->NodeAt(places[k]), 1, [&](std::size_t other, const Vec3& offset) {
          if (layer_[other] == 0 || layer_[other] > layer) return;
          const double weight = 1 / offset.squaredNorm();
          const Mat3& there = slopes[number_of_[other]];
          value += weight * (field[other] - there * offset - own * offset);
          mean += weight * there;
          total += weight;
        });
        field[places[k]] = value / total;
        slopes[number_of_[places[k]]] = mean / total;
      }
    });
  }
}

std::size_t Band::NodeCount(int layers) const {
  std::size_t count = 0;
  for (int layer = 0; layer <= layers; ++layer) count += places_[layer].size();
  return count;
}

}  // namespace fascicle
