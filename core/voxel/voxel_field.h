#ifndef FASCICLE_CORE_VOXEL_VOXEL_FIELD_H_
#define FASCICLE_CORE_VOXEL_VOXEL_FIELD_H_

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/linalg/nodal_vector.h"

namespace fascicle {

// Three components for each node of a VoxelMesh, stored component by component, along the axes of the grid. Each
// component is followed by zeros, so that vector instructions may read beyond the last node; all sums and products keep
// them zero.
template <class S>
class VoxelField {
 public:
  static constexpr std::int32_t kPadding = 32;

  VoxelField() = default;
  explicit VoxelField(std::int32_t nodes) : nodes_(nodes), stride_(StrideOf(nodes)), values_(3 * stride_, S{0}) {}
  static std::size_t StrideOf(std::int32_t nodes) {
    return (static_cast<std::size_t>(nodes) + kPadding + 15) / 16 * 16;
  }

  std::int32_t nodes() const { return nodes_; }
  // Distance between components in memory, in numbers.
  std::size_t stride() const { return stride_; }
  std::size_t size() const { return values_.size(); }
  S* data() { return values_.data(); }
  const S* data() const { return values_.data(); }
  S* component(int d) { return values_.data() + d * stride_; }
  const S* component(int d) const { return values_.data() + d * stride_; }
  S& operator()(std::int32_t node, int d) { return values_[d * stride_ + node]; }
  const S& operator()(std::int32_t node, int d) const { return values_[d * stride_ + node]; }
  Vec3 At(std::int32_t node) const {
    return {static_cast<double>((*this)(node, 0)), static_cast<double>((*this)(node, 1)),
            static_cast<double>((*this)(node, 2))};
  }
  void Add(std::int32_t node, const Vec3& v) {
    for (int d = 0; d < 3; ++d) (*this)(node, d) += static_cast<S>(v[d]);
  }

 private:
  std::int32_t nodes_ = 0;
  std::size_t stride_ = 0;
  std::vector<S> values_;
};

// Calls body(k) for the index k of every component of every node.
template <class Body>
void ForNumbers(ThreadTeam& team, std::size_t count, const Body& body) {
  team.For(count, 3 * kNodeGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) body(k);
  });
}

// Sum of term(k) over all indices, eight at a time, in an order that depends on their count only.
template <class Term>
double SumOverNumbers(ThreadTeam& team, std::size_t count, const Term& term) {
  return team.Sum(count, [&](std::size_t begin, std::size_t end) {
    double sums[8] = {};
    std::size_t k = begin;
    for (; k + 8 <= end; k += 8) {
      for (int lane = 0; lane < 8; ++lane) sums[lane] += term(k + lane);
    }
    for (; k < end; ++k) sums[0] += term(k);
    return ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7]));
  });
}

template <class S, class T>
double Dot(ThreadTeam& team, const VoxelField<S>& x, const VoxelField<T>& y) {
  const S* const a = x.data();
  const T* const b = y.data();
  return SumOverNumbers(team, x.size(),
                        [a, b](std::size_t k) { return static_cast<double>(a[k]) * static_cast<double>(b[k]); });
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_VOXEL_FIELD_H_
