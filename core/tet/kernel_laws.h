#ifndef FASCICLE_CORE_TET_KERNEL_LAWS_H_
#define FASCICLE_CORE_TET_KERNEL_LAWS_H_

#include "core/base/lanes.h"
#include "core/materials/material.h"
#include "core/tet/element_blocks.h"

// The laws on blocks of points. Part of kernels_impl.h, with its rules: templates on the Lanes type only.
namespace fascicle {

// Values of one kind at one point of a block's elements.
template <class S>
struct alignas(64) BlockMatrix {
  S m[9][kBlock];
};

// Arguments of a law at the points of a block.
template <class S>
struct alignas(64) PointBlock {
  BlockMatrix<S> F;
  S previous_stretch[kBlock];
  S activation[kBlock];
  const BlockFibres<S>* fibres;
  double inverse_step;
};

template <class L, class Matrix>
Matrix3<L> LoadMatrix(const Matrix& block, int lane) {
  Matrix3<L> a;
  for (int k = 0; k < 9; ++k) a.m[k] = L::Load(&block[k][lane]);
  return a;
}
template <class L, class Matrix>
void StoreMatrix(const Matrix3<L>& a, int lane, Matrix& block) {
  for (int k = 0; k < 9; ++k) a.m[k].Store(&block[k][lane]);
}
template <class L, class Vector>
Vector3<L> LoadVector(const Vector& block, int lane) {
  return {{L::Load(&block[0][lane]), L::Load(&block[1][lane]), L::Load(&block[2][lane])}};
}

// The functions of one law on a block of points.
template <class S>
struct LawKernels {
  bool needs_fibres;
  void (*stress)(const void* law, const PointBlock<S>&, BlockMatrix<S>& P);
  void (*energy)(const void* law, const PointBlock<S>&, S* density);
  void (*product)(const void* law, const PointBlock<S>&, const BlockMatrix<S>& dF, BlockMatrix<S>& dP);
  void (*tangent)(const void* law, const PointBlock<S>&, S (*H)[kBlock]);
};

template <class L, class Law>
struct LawOnBlocks {
  using S = typename L::Scalar;

  static Fibre<L> FibreOf(const PointBlock<S>& at, int lane) {
    return {LoadVector<L>(at.fibres->direction, lane), L::Load(&at.activation[lane]),
            L::Load(&at.previous_stretch[lane]), at.inverse_step};
  }
  // Inlined completely, so that vectors stay in registers.
  [[gnu::flatten]] static void Stress(const void* law, const PointBlock<S>& at, BlockMatrix<S>& P) {
    for (int k = 0; k < kBlock; k += L::kLanes) {
      StoreMatrix(static_cast<const Law*>(law)->StressAt(LoadMatrix<L>(at.F.m, k), FibreOf(at, k)), k, P.m);
    }
  }
  static void Energy(const void* law, const PointBlock<S>& at, S* density) {
    for (int k = 0; k < kBlock; k += L::kLanes) {
      static_cast<const Law*>(law)->EnergyAt(LoadMatrix<L>(at.F.m, k), FibreOf(at, k)).Store(&density[k]);
    }
  }
  [[gnu::flatten]] static void Product(const void* law, const PointBlock<S>& at, const BlockMatrix<S>& dF,
                                       BlockMatrix<S>& dP) {
    for (int k = 0; k < kBlock; k += L::kLanes) {
      TangentProduct<L> terms(LoadMatrix<L>(dF.m, k));
      static_cast<const Law*>(law)->AddTangentAt(LoadMatrix<L>(at.F.m, k), FibreOf(at, k), terms);
      StoreMatrix(terms.dP(), k, dP.m);
    }
  }
  static void Tangent(const void* law, const PointBlock<S>& at, S (*H)[kBlock]) {
    for (int k = 0; k < kBlock; k += L::kLanes) {
      TangentMatrix<L> terms;
      static_cast<const Law*>(law)->AddTangentAt(LoadMatrix<L>(at.F.m, k), FibreOf(at, k), terms);
      for (int i = 0; i < TangentMatrix<L>::kEntries; ++i) terms[i].Store(&H[i][k]);
    }
  }
  static constexpr LawKernels<S> kKernels = {Law::kNeedsFibres, &Stress, &Energy, &Product, &Tangent};
};

template <class L, class List>
struct LawList;
template <class L, class... Laws>
struct LawList<L, std::variant<Laws...>> {
  static constexpr LawKernels<typename L::Scalar> kKernels[] = {LawOnBlocks<L, Laws>::kKernels...};
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_KERNEL_LAWS_H_
