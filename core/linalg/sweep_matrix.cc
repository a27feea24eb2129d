#include "core/linalg/sweep_matrix.h"

#include <algorithm>

namespace fascicle {
namespace {

// Least number of rows that a thread takes at a time.
constexpr std::size_t kRowsAtATime = 128;

}  // namespace

SweepMatrix::SweepMatrix(const BlockPattern& pattern, std::span<const Vec3> positions)
    : order_(pattern, positions),
      diagonal_source_(pattern.rows()),
      diagonal_(pattern.rows()),
      inverse_diagonal_(pattern.rows()) {
  lower_.begin = upper_.begin = {0};
  std::vector<std::pair<std::int32_t, std::int32_t>> sorted;  // column and source of each block of a row
  for (std::size_t i = 0; i < rows(); ++i) {
    const std::int32_t row = order_.row[i];
    sorted.clear();
    for (std::int32_t k = pattern.begin[row]; k < pattern.begin[row + 1]; ++k) {
      sorted.emplace_back(order_.place[pattern.column[k]], k);
    }
    std::sort(sorted.begin(), sorted.end());
    for (const auto& [column, source] : sorted) {
      if (column == static_cast<std::int32_t>(i)) {
        diagonal_source_[i] = source;
        continue;
      }
      Part& part = column < static_cast<std::int32_t>(i) ? lower_ : upper_;
      part.column.push_back(column);
      part.source.push_back(source);
    }
    for (Part* part : {&lower_, &upper_}) part->begin.push_back(static_cast<std::int32_t>(part->column.size()));
  }
  for (Part* part : {&lower_, &upper_}) part->blocks.resize(part->column.size());
}

void SweepMatrix::SetValues(const BlockValues& values, ThreadTeam& team) {
  team.For(rows(), kRowsAtATime, [&](std::size_t begin, std::size_t end) {
    for (Part* part : {&lower_, &upper_}) {
      for (std::int32_t k = part->begin[begin]; k < part->begin[end]; ++k) {
        part->blocks.Set(k, values[part->source[k]]);
      }
    }
    for (std::size_t i = begin; i < end; ++i) {
      const Mat3& block = values[diagonal_source_[i]];
      diagonal_[i] = FloatBlock(block);
      inverse_diagonal_[i] = FloatBlock(PositiveInverse(block));
    }
  });
}

void SweepMatrix::Multiply(const FloatField& x, ThreadTeam& team, FloatField& product) const {
  team.For(rows(), kRowsAtATime, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec4f sum = Vec4f::Zero();
      lower_.AddRow(i, x, sum);
      upper_.AddRow(i, x, sum);
      sum[3] = 0;
      product[i] = sum + diagonal_[i] * x[i];
    }
  });
}

// Calls visit(i) for all places, colour by colour.
template <class Visit>
void SweepMatrix::Forward(ThreadTeam& team, const Visit& visit) const {
  for (std::size_t colour = 0; colour + 1 < order_.colour_begin.size(); ++colour) {
    const std::int32_t first = order_.colour_begin[colour];
    team.For(order_.colour_begin[colour + 1] - first, 1, [&](std::size_t begin, std::size_t end) {
      for (std::int32_t i = order_.chunk_begin[first + begin]; i < order_.chunk_begin[first + end]; ++i) visit(i);
    });
  }
}

// The same in the opposite order.
template <class Visit>
void SweepMatrix::Backward(ThreadTeam& team, const Visit& visit) const {
  for (std::size_t colour = order_.colour_begin.size() - 1; colour-- > 0;) {
    const std::int32_t first = order_.colour_begin[colour];
    team.For(order_.colour_begin[colour + 1] - first, 1, [&](std::size_t begin, std::size_t end) {
      for (std::int32_t i = order_.chunk_begin[first + end]; i-- > order_.chunk_begin[first + begin];) visit(i);
    });
  }
}

void SweepMatrix::SweepFromZero(const FloatField& b, ThreadTeam& team, FloatField& x) const {
  Forward(team, [&](std::size_t i) {
    Vec4f sum = Vec4f::Zero();
    lower_.AddRow(i, x, sum);
    x[i] = inverse_diagonal_[i] * (b[i] - sum);
  });
}

void SweepMatrix::ResidualAfterSweep(const FloatField& x, ThreadTeam& team, FloatField& r) const {
  team.For(rows(), kRowsAtATime, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec4f sum = Vec4f::Zero();
      upper_.AddRow(i, x, sum);
      sum[3] = 0;
      r[i] = -sum;
    }
  });
}

void SweepMatrix::SweepBackFromSweep(ThreadTeam& team, FloatField& x) const {
  Backward(team, [&](std::size_t i) {
    Vec4f sum = Vec4f::Zero();
    upper_.AddRowBackward(i, x, sum);
    x[i] -= inverse_diagonal_[i] * sum;
  });
}

void SweepMatrix::SweepBack(const FloatField& b, ThreadTeam& team, FloatField& x) const {
  Backward(team, [&](std::size_t i) {
    Vec4f sum = Vec4f::Zero();
    lower_.AddRowBackward(i, x, sum);
    upper_.AddRowBackward(i, x, sum);
    x[i] = inverse_diagonal_[i] * (b[i] - sum);
  });
}

}  // namespace fascicle
