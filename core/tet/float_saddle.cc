#include "core/tet/float_saddle.h"

#include <cmath>

namespace fascicle {
namespace {

// Factor of diag(B diag(A)^-1 B^T) in the Schur complement.
constexpr double kSchurScale = 4;
// Least diagonal entry that scales an equation, relative to its block.
constexpr double kLeastDiagonal = 1e-6;

}  // namespace

double SaddleSpace::Dot(const SaddleField& a, const SaddleField& b) const {
  const double of_nodes = team.Sum(nodes, [&](std::size_t begin, std::size_t end) {
    Vec4f sum = Vec4f::Zero();
    for (std::size_t n = begin; n < end; ++n) sum += a.x[n].cwiseProduct(b.x[n]);
    return static_cast<double>(sum.sum());
  });
  const double of_patches = team.Sum(patches, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t n = begin; n < end; ++n) sum += static_cast<double>(a.p[n]) * b.p[n];
    return sum;
  });
  return of_nodes + of_patches;
}

void SaddleSpace::Add(double scale, const SaddleField& v, SaddleField& sum) const {
  const auto factor = static_cast<float>(scale);
  ForNodes(team, nodes, [&](std::size_t n) { sum.x[n] += factor * v.x[n]; });
  for (std::size_t n = 0; n < patches; ++n) sum.p[n] += factor * v.p[n];
}

void SaddleSpace::Scale(double scale, SaddleField& v) const {
  const auto factor = static_cast<float>(scale);
  ForNodes(team, nodes, [&](std::size_t n) { v.x[n] *= factor; });
  for (std::size_t n = 0; n < patches; ++n) v.p[n] *= factor;
}

FloatSaddle::FloatSaddle(const SaddleMatrix& matrix, const SweepOrder& order) : order_(order) {
  rows_ = matrix.volume_pattern;
  for (std::int32_t& column : rows_.column) column = order.place[column];
  const TransposedPattern& of_node = matrix.volume_of_node;
  for (const std::int32_t n : order.row) {
    for (std::int32_t k = of_node.pattern.begin[n]; k < of_node.pattern.begin[n + 1]; ++k) {
      columns_.column.push_back(of_node.pattern.column[k]);
      columns_source_.push_back(of_node.source[k]);
    }
    columns_.begin.push_back(static_cast<std::int32_t>(columns_.column.size()));
  }
  B_.resize(rows_.blocks());
  B_transposed_.resize(rows_.blocks());
  C_.resize(matrix.patches());
  patch_scale_.resize(matrix.patches());
  scale_.resize(matrix.nodes());
  inverse_scale_.resize(matrix.nodes());
}

void FloatSaddle::SetValues(const SaddleMatrix& matrix, ThreadTeam& team) {
  ForNodes(team, matrix.nodes(), [&](std::size_t i) {
    const std::int32_t n = order_.row[i];
    const Mat3& diagonal = matrix.A[matrix.pattern.PlaceOf(n, n)];
    const double least = kLeastDiagonal * diagonal.norm();
    scale_[i].setZero();
    inverse_scale_[i].setZero();
    for (int c = 0; c < 3; ++c) {
      const double root = std::sqrt(std::max(std::abs(diagonal(c, c)), least));
      scale_[i][c] = static_cast<float>(1 / root);
      inverse_scale_[i][c] = static_cast<float>(root);
    }
    for (std::int32_t k = columns_.begin[i]; k < columns_.begin[i + 1]; ++k) {
      B_transposed_[k] << matrix.B[columns_source_[k]].cast<float>(), 0;
    }
  });
  team.For(matrix.patches(), kNodeGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      double sum = 0;
      for (std::int32_t k = rows_.begin[p]; k < rows_.begin[p + 1]; ++k) {
        B_[k] << matrix.B[k].cast<float>(), 0;
        sum += B_[k].cwiseProduct(scale_[rows_.column[k]]).squaredNorm();
      }
      C_[p] = static_cast<float>(matrix.C[p]);
      patch_scale_[p] = static_cast<float>(1 / std::sqrt(matrix.C[p] + kSchurScale * sum));
    }
  });
}

void FloatSaddle::FromDouble(const NodalVector& force, std::span<const double> volume, double factor, ThreadTeam& team,
                             SaddleField& result) const {
  result.x.resize(force.size());
  result.p.resize(volume.size());
  ForNodes(team, force.size(), [&](std::size_t i) {
    result.x[i] << (factor * force[order_.row[i]]).cast<float>(), 0;
    result.x[i] = result.x[i].cwiseProduct(scale_[i]).eval();
  });
  for (std::size_t n = 0; n < volume.size(); ++n) {
    result.p[n] = static_cast<float>(factor * volume[n] * patch_scale_[n]);
  }
}

void FloatSaddle::AddTo(NodalVector& dx, std::span<double> dp, double factor, ThreadTeam& team,
                        const SaddleField& field) const {
  ForNodes(team, dx.size(), [&](std::size_t i) { dx[order_.row[i]] += factor * field.x[i].head<3>().cast<double>(); });
  for (std::size_t n = 0; n < dp.size(); ++n) dp[n] += factor * field.p[n];
}

double FloatSaddle::NormOf(const NodalVector& force, std::span<const double> volume, ThreadTeam& team) const {
  double squares = SumOverNodes(team, force.size(), [&](std::size_t i) {
    return force[order_.row[i]].cwiseProduct(scale_[i].head<3>().cast<double>()).squaredNorm();
  });
  for (std::size_t n = 0; n < volume.size(); ++n) squares += std::pow(volume[n] * patch_scale_[n], 2);
  return std::sqrt(squares);
}

void FloatSaddle::Multiply(const SweepMatrix& A, const SaddleField& z, ThreadTeam& team, SaddleField& side) const {
  side.x.resize(z.x.size());
  side.p.resize(z.p.size());
  A.Multiply(z.x, team, side.x);
  ForNodes(team, z.x.size(), [&](std::size_t i) {
    Vec4f sum = side.x[i];
    for (std::int32_t k = columns_.begin[i]; k < columns_.begin[i + 1]; ++k) {
      sum += z.p[columns_.column[k]] * B_transposed_[k];
    }
    side.x[i] = sum.cwiseProduct(scale_[i]);
  });
  team.For(z.p.size(), kNodeGrain / 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      Vec4f sum = Vec4f::Zero();
      for (std::int32_t k = rows_.begin[n]; k < rows_.begin[n + 1]; ++k) {
        sum += B_[k].cwiseProduct(z.x[rows_.column[k]]);
      }
      side.p[n] = patch_scale_[n] * (sum.sum() - C_[n] * z.p[n]);
    }
  });
}

void FloatSaddle::EliminatePressure(const SaddleField& side, ThreadTeam& team, std::vector<float>& p,
                                    FloatField& force) const {
  p.resize(side.p.size());
  force.resize(side.x.size());
  for (std::size_t n = 0; n < p.size(); ++n) p[n] = -patch_scale_[n] * side.p[n];
  ForNodes(team, force.size(), [&](std::size_t i) {
    Vec4f sum = inverse_scale_[i].cwiseProduct(side.x[i]);
    for (std::int32_t k = columns_.begin[i]; k < columns_.begin[i + 1]; ++k) {
      sum -= p[columns_.column[k]] * B_transposed_[k];
    }
    force[i] = sum;
  });
}

}  // namespace fascicle
