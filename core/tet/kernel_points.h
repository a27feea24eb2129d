#ifndef FASCICLE_CORE_TET_KERNEL_POINTS_H_
#define FASCICLE_CORE_TET_KERNEL_POINTS_H_

#include "core/tet/kernel_laws.h"
#include "core/tet/kernel_nodes.h"

// Points of elements. Part of kernels_impl.h, with its rules: templates on the Lanes type only.
namespace fascicle {

// What laws and damping need at the points of a block's elements.
template <class L, class Shape>
struct ElementPoints {
  using S = typename L::Scalar;
  using Nodes = ElementNodes<L, Shape>;
  using NodeValues = typename Nodes::NodeValues;
  static constexpr int kNodes = Shape::kNodes, kPoints = Shape::kPoints;

  // Prefetches a later block while this one is processed, to hide the latency of memory.
  static constexpr int kBlocksAhead = 3;
  static void Prefetch(const ChunkTask<S>& task, std::size_t b) {
    if (b * kBlock >= task.elements) return;
    const auto fetch = [](const void* begin, std::size_t bytes) {
      for (std::size_t at = 0; at < bytes; at += 64) __builtin_prefetch(static_cast<const char*>(begin) + at);
    };
    fetch(task.points + kPoints * b, kPoints * sizeof(RestPoint<S>));
    if (HasFibres(task)) fetch(task.fibres + b, sizeof(BlockFibres<S>));
    fetch(task.local + b * kNodes * kBlock, kNodes * kBlock * sizeof(std::uint16_t));
  }

  // Laws without fibres do not read them, which saves memory bandwidth.
  static bool HasFibres(const ChunkTask<S>& task) {
    return task.law != nullptr && LawList<L, Material>::kKernels[task.law_kind].needs_fibres;
  }
  static void SetActivation(const ChunkTask<S>& task, const BlockFibres<S>& fibres, PointBlock<S>& point) {
    point.fibres = &fibres;
    point.inverse_step = task.inverse_step;
    if (!HasFibres(task)) return;
    std::int32_t different = 0;
    for (int k = 0; k < kBlock; ++k) different |= fibres.activation[k] ^ fibres.activation[0];
    const S first = static_cast<S>(task.activation[fibres.activation[0]]);
    for (int k = 0; k < kBlock; ++k) {
      point.activation[k] = first * fibres.activation_scale[k];
      point.previous_stretch[k] = 1;
    }
    if (different == 0) return;
    for (int k = 0; k < kBlock; ++k) {
      point.activation[k] = static_cast<S>(task.activation[fibres.activation[k]]) * fibres.activation_scale[k];
    }
  }
  static bool HasRate(const ChunkTask<S>& task) { return task.inverse_step != 0 && task.law != nullptr; }
  static bool IsViscous(const ChunkTask<S>& task) { return task.mu != 0 || task.lambda != 0; }

  // Isochoric stretch |F a0| / J^(1/3).
  static void SetPreviousStretch(const NodeValues& previous, const RestPoint<S>& rest, int q, PointBlock<S>& point) {
    for (int k = 0; k < kBlock; k += L::kLanes) {
      const Matrix3<L> F = Nodes::Gradient(previous, rest, q, k);
      const Vector3<L> a = F * LoadVector<L>(point.fibres->direction, k);
      (Sqrt(Dot(a, a)) * InverseCubeRoot(Determinant(F))).Store(&point.previous_stretch[k]);
    }
  }

  // The strain E of the viscous stress.
  static Matrix3<L> StrainOf(const ChunkTask<S>& task, const Matrix3<L>& F, const NodeValues& other,
                             const RestPoint<S>& rest, int q, int k) {
    const Matrix3<L> G = Nodes::Gradient(other, rest, q, k);
    if (task.v != nullptr) return SymmetricPart(::fascicle::Transpose(F) * G);
    return 0.5 * (::fascicle::Transpose(F) * F - ::fascicle::Transpose(G) * G);
  }
  static Matrix3<L> ViscousStress(const ChunkTask<S>& task, const Matrix3<L>& E) {
    return PlusDiagonal(2 * task.mu * E, task.lambda * Trace(E));
  }
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_KERNEL_POINTS_H_
