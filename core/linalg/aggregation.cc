#include "core/linalg/aggregation.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace fascicle {
namespace {

constexpr std::int32_t kNone = -1;
// Nodes are strongly coupled when the coupling exceeds this part of the geometric mean of their diagonal blocks.
// Between aggregates, which are isotropic already, any coupling is strong.
constexpr double kStrong = 0.02;

// The points of a level: one block each (translation) on the finest level, two (translation, rotation) on all others.
struct Points {
  std::size_t blocks_each = 1;
  std::size_t count = 0;
};

Points PointsOf(const std::vector<RigidBlock>& blocks) {
  const bool pairs = blocks.size() >= 2 && blocks[1].rotation_scale > 0;
  return {pairs ? 2u : 1u, pairs ? blocks.size() / 2 : blocks.size()};
}

// Strongly coupled neighbours of each point.
std::vector<std::vector<std::int32_t>> StrongNeighbours(const BlockPattern& pattern, const BlockValues& values,
                                                        const Points& points) {
  std::vector<double> diagonal(pattern.rows());
  for (std::size_t i = 0; i < pattern.rows(); ++i) {
    diagonal[i] = values[pattern.PlaceOf(static_cast<std::int32_t>(i), static_cast<std::int32_t>(i))].norm();
  }
  std::vector<std::vector<std::int32_t>> neighbours(points.count);
  for (std::size_t p = 0; p < points.count; ++p) {
    const std::size_t i = p * points.blocks_each;  // translations decide
    for (std::int32_t k = pattern.begin[i]; k < pattern.begin[i + 1]; ++k) {
      const std::size_t j = pattern.column[k];
      if (j == i || j % points.blocks_each != 0) continue;
      if (points.blocks_each > 1 || values[k].norm() > kStrong * std::sqrt(diagonal[i] * diagonal[j])) {
        neighbours[p].push_back(static_cast<std::int32_t>(j / points.blocks_each));
      }
    }
  }
  return neighbours;
}

// The aggregate of each point. First, whole neighbourhoods that touch no aggregate become aggregates. Each remaining
// point joins a neighbouring aggregate or forms its own.
std::vector<std::int32_t> Aggregate(const std::vector<std::vector<std::int32_t>>& neighbours, std::size_t& count) {
  std::vector<std::int32_t> of(neighbours.size(), kNone);
  count = 0;
  for (std::size_t p = 0; p < of.size(); ++p) {
    const auto taken = [&](std::int32_t n) { return of[n] != kNone; };
    if (taken(static_cast<std::int32_t>(p)) || neighbours[p].empty() ||
        std::any_of(neighbours[p].begin(), neighbours[p].end(), taken)) {
      continue;
    }
    of[p] = static_cast<std::int32_t>(count);
    for (const std::int32_t n : neighbours[p]) of[n] = static_cast<std::int32_t>(count);
    ++count;
  }
  const std::vector<std::int32_t> roots = of;
  for (std::size_t p = 0; p < of.size(); ++p) {
    if (of[p] != kNone) continue;
    for (const std::int32_t n : neighbours[p]) {
      if (roots[n] != kNone) {
        of[p] = roots[n];
        break;
      }
    }
  }
  for (std::size_t p = 0; p < of.size(); ++p) {
    if (of[p] != kNone) continue;
    of[p] = static_cast<std::int32_t>(count);
    for (const std::int32_t n : neighbours[p]) {
      if (of[n] == kNone) of[n] = static_cast<std::int32_t>(count);
    }
    ++count;
  }
  return of;
}

// Centre and radius of each aggregate, as a translation block and a rotation block.
std::vector<RigidBlock> RigidBlocksOf(const std::vector<RigidBlock>& blocks, const Points& points,
                                      const std::vector<std::int32_t>& aggregate, std::size_t count) {
  std::vector<RigidBlock> coarse(2 * count);
  std::vector<double> size(count, 0), squares(count, 0);
  for (std::size_t p = 0; p < points.count; ++p) {
    coarse[2 * aggregate[p]].position += blocks[p * points.blocks_each].position;
    ++size[aggregate[p]];
  }
  for (std::size_t a = 0; a < count; ++a) coarse[2 * a].position /= size[a];
  for (std::size_t p = 0; p < points.count; ++p) {
    const Vec3 arm = blocks[p * points.blocks_each].position - coarse[2 * aggregate[p]].position;
    squares[aggregate[p]] += arm.squaredNorm();
  }
  double typical = 0;
  for (std::size_t a = 0; a < count; ++a) typical = std::max(typical, std::sqrt(squares[a] / size[a]));
  for (std::size_t a = 0; a < count; ++a) {
    coarse[2 * a + 1].position = coarse[2 * a].position;
    // An aggregate of a single point has no extent; any length will do.
    const double radius = std::sqrt(squares[a] / size[a]);
    coarse[2 * a + 1].rotation_scale = radius > 0 ? radius : (typical > 0 ? typical : 1);
  }
  return coarse;
}

Mat3 CrossProductWith(const Vec3& arm) {
  Mat3 cross;  // cross * w = w x arm
  cross << 0, arm[2], -arm[1], -arm[2], 0, arm[0], arm[1], -arm[0], 0;
  return cross;
}

// How block i moves with the rigid motion of its aggregate: one block for the translation and one for the rotation.
std::array<Mat3, 2> RigidMotion(const RigidBlock& block, const RigidBlock& rotation, const std::array<bool, 3>& free) {
  std::array<Mat3, 2> motion = {Mat3::Identity(), Mat3::Zero()};
  if (block.rotation_scale > 0) {
    motion[0].setZero();
    motion[1] = (block.rotation_scale / rotation.rotation_scale) * Mat3::Identity();
  } else {
    motion[1] = CrossProductWith(block.position - rotation.position) / rotation.rotation_scale;
  }
  for (int c = 0; c < 3; ++c) {
    if (free[c]) continue;
    motion[0].row(c).setZero();
    motion[1].row(c).setZero();
  }
  return motion;
}

}  // namespace

Prolongation SmoothedAggregation(const BlockPattern& pattern, const BlockValues& values, const FreeComponents& free,
                                 const std::vector<RigidBlock>& blocks, const BlockValues& inverse_diagonal,
                                 double largest_eigenvalue, std::vector<RigidBlock>& coarse_blocks) {
  const Points points = PointsOf(blocks);
  std::size_t count = 0;
  const std::vector<std::int32_t> aggregate = Aggregate(StrongNeighbours(pattern, values, points), count);
  coarse_blocks = RigidBlocksOf(blocks, points, aggregate, count);
  std::vector<std::array<Mat3, 2>> motion(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    motion[i] = RigidMotion(blocks[i], coarse_blocks[2 * aggregate[i / points.blocks_each] + 1], free[i]);
  }
  // P = (I - w D^-1 A) T, w = 4/3 over the largest eigenvalue.
  const double damping = 4.0 / 3.0 / largest_eigenvalue;
  Prolongation result;
  result.coarse = coarse_blocks.size();
  PatternBuilder builder;
  std::vector<std::int32_t> columns;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    columns.clear();
    for (std::int32_t k = pattern.begin[i]; k < pattern.begin[i + 1]; ++k) {
      const std::int32_t a = aggregate[pattern.column[k] / points.blocks_each];
      columns.push_back(2 * a);
      columns.push_back(2 * a + 1);
    }
    builder.AddRow(columns);
  }
  result.pattern = builder.Take();
  result.values.assign(result.pattern.blocks(), Mat3::Zero());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (std::int32_t k = pattern.begin[i]; k < pattern.begin[i + 1]; ++k) {
      const std::size_t j = pattern.column[k];
      Mat3 weight = -damping * inverse_diagonal[i] * values[k];
      if (i == j) weight += Mat3::Identity();
      const std::int32_t place =
          result.pattern.PlaceOf(static_cast<std::int32_t>(i), 2 * aggregate[j / points.blocks_each]);
      for (int kind = 0; kind < 2; ++kind) result.values[place + kind] += weight * motion[j][kind];
    }
    for (std::int32_t k = result.pattern.begin[i]; k < result.pattern.begin[i + 1]; ++k) {
      for (int c = 0; c < 3; ++c) {
        if (!free[i][c]) result.values[k].row(c).setZero();
      }
    }
  }
  return result;
}

GalerkinProduct::GalerkinProduct(const BlockPattern& fine, const Prolongation& p) : restriction_(p.pattern, p.coarse) {
  PatternBuilder product, coarse;
  std::vector<std::int32_t> columns;
  for (std::size_t i = 0; i < fine.rows(); ++i) {
    columns.clear();
    for (std::int32_t k = fine.begin[i]; k < fine.begin[i + 1]; ++k) {
      const std::int32_t j = fine.column[k];
      columns.insert(columns.end(), p.pattern.column.begin() + p.pattern.begin[j],
                     p.pattern.column.begin() + p.pattern.begin[j + 1]);
    }
    product.AddRow(columns);
  }
  product_ = product.Take();
  const BlockPattern& transposed = restriction_.pattern;
  for (std::size_t J = 0; J < p.coarse; ++J) {
    columns.assign(1, static_cast<std::int32_t>(J));
    for (std::int32_t k = transposed.begin[J]; k < transposed.begin[J + 1]; ++k) {
      const std::int32_t i = transposed.column[k];
      columns.insert(columns.end(), product_.column.begin() + product_.begin[i],
                     product_.column.begin() + product_.begin[i + 1]);
    }
    coarse.AddRow(columns);
  }
  coarse_ = coarse.Take();
}

void GalerkinProduct::Compute(const BlockPattern& fine, const BlockValues& values, const Prolongation& p,
                              ThreadTeam& team, BlockValues& coarse_values) {
  product_values_.resize(product_.blocks());
  coarse_values.resize(coarse_.blocks());
  if (p.is_diagonal) {
    // Nine products for each pair of blocks instead of 27.
    std::vector<Vec3> weights;
    for (const Mat3& block : p.values) weights.emplace_back(block.diagonal());
    Multiply(fine, p.pattern, product_, team, product_values_, [&](Mat3& sum, std::int32_t k, std::int32_t m) {
      for (int c = 0; c < 3; ++c) sum.col(c) += weights[m][c] * values[k].col(c);
    });
    Multiply(restriction_.pattern, product_, coarse_, team, coarse_values,
             [&](Mat3& sum, std::int32_t k, std::int32_t m) {
               const Vec3& weight = weights[restriction_.source[k]];
               for (int c = 0; c < 3; ++c) sum.col(c) += weight.cwiseProduct(product_values_[m].col(c));
             });
    return;
  }
  Multiply(fine, p.pattern, product_, team, product_values_,
           [&](Mat3& sum, std::int32_t k, std::int32_t m) { sum += values[k] * p.values[m]; });
  Multiply(restriction_.pattern, product_, coarse_, team, coarse_values,
           [&](Mat3& sum, std::int32_t k, std::int32_t m) {
             sum += p.values[restriction_.source[k]].transpose() * product_values_[m];
           });
}

// values = left times right on the pattern `product`; add(sum, k, m) adds the product of their blocks k and m.
template <class Add>
void GalerkinProduct::Multiply(const BlockPattern& left, const BlockPattern& right, const BlockPattern& product,
                               ThreadTeam& team, BlockValues& values, const Add& add) {
  team.For(left.rows(), 64, [&](std::size_t begin, std::size_t end) {
    std::vector<std::int32_t> place_of;  // of each column in the current row
    for (std::size_t i = begin; i < end; ++i) {
      for (std::int32_t k = product.begin[i]; k < product.begin[i + 1]; ++k) {
        const auto column = static_cast<std::size_t>(product.column[k]);
        if (column >= place_of.size()) place_of.resize(column + 1);
        place_of[column] = k;
        values[k].setZero();
      }
      for (std::int32_t k = left.begin[i]; k < left.begin[i + 1]; ++k) {
        const std::int32_t j = left.column[k];
        for (std::int32_t m = right.begin[j]; m < right.begin[j + 1]; ++m) {
          add(values[place_of[right.column[m]]], k, m);
        }
      }
    }
  });
}

}  // namespace fascicle
