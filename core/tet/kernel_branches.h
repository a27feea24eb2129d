#ifndef FASCICLE_CORE_TET_KERNEL_BRANCHES_H_
#define FASCICLE_CORE_TET_KERNEL_BRANCHES_H_

#include "core/tet/kernel_laws.h"
#include "core/tet/kernels.h"

// Viscoelasticity. Part of kernels_impl.h, with its rules: templates on the Lanes type only.
namespace fascicle {

// Maxwell branches at the points of a block's elements, in double precision only; not inlined, so that loops without
// them stay small.
template <class L, class Shape>
struct ElementBranches {
  using S = typename L::Scalar;
  static constexpr int kPoints = Shape::kPoints;

  static bool HasBranches(const ChunkTask<S>& task) { return sizeof(S) == 8 && task.branch_law != nullptr; }
  // The same point without activation and rate.
  static void SetPassive(const PointBlock<S>& point, PointBlock<S>& passive) {
    passive.F = point.F;
    passive.fibres = point.fibres;
    passive.inverse_step = 0;
    for (int k = 0; k < kBlock; ++k) {
      passive.activation[k] = 0;
      passive.previous_stretch[k] = 1;
    }
  }
  // A symmetric matrix from its components xx, yy, zz, xy, yz, zx.
  static Matrix3<L> LoadSymmetric(const double* tensor, int k) {
    L c[6];
    for (int i = 0; i < 6; ++i) {
      if constexpr (sizeof(S) == 8) {
        c[i] = L::Load(tensor + i * kBlock + k);
      } else {
        c[i] = 0.0;
      }
    }
    return {{c[0], c[3], c[5], c[3], c[1], c[4], c[5], c[4], c[2]}};
  }
  static void StoreSymmetric(const Matrix3<L>& a, double* tensor, int k) {
    const L c[6] = {a(0, 0), a(1, 1), a(2, 2), a(0, 1), a(1, 2), a(2, 0)};
    for (int i = 0; i < 6; ++i) {
      for (int lane = 0; lane < L::kLanes; ++lane) tensor[i * kBlock + k + lane] = c[i][lane];
    }
  }
  static const double* BranchStressAt(const ChunkTask<S>& task, std::size_t b, int q) {
    return task.branch_stress + kBranchTensor * (kPoints * b + q);
  }

  // Adds factor P_p + F B to the stress, and factor W_p + B : E to the energy.
  [[gnu::noinline]] static void AddBranches(const ChunkTask<S>& task, std::size_t b, int q, const PointBlock<S>& point,
                                            BlockMatrix<S>& P, S* density) {
    PointBlock<S> passive;
    SetPassive(point, passive);
    BlockMatrix<S> of_law;
    alignas(64) S energy[kBlock];
    const LawKernels<S>& law = LawList<L, Material>::kKernels[task.law_kind];
    law.stress(task.branch_law, passive, of_law);
    if (task.with_energy) law.energy(task.branch_law, passive, energy);
    for (int k = 0; k < kBlock; k += L::kLanes) {
      const Matrix3<L> F = LoadMatrix<L>(point.F.m, k);
      const Matrix3<L> B = LoadSymmetric(BranchStressAt(task, b, q), k);
      StoreMatrix(LoadMatrix<L>(P.m, k) + (task.branch_factor * LoadMatrix<L>(of_law.m, k) + F * B), k, P.m);
      if (!task.with_energy) continue;
      const Matrix3<L> C = PlusDiagonal(::fascicle::Transpose(F) * F, -1);
      const L added = task.branch_factor * L::Load(&energy[k]) + 0.5 * Contract(B, C);
      (L::Load(&density[k]) + added).Store(&density[k]);
    }
  }
  // Adds the product of their tangent with dF.
  [[gnu::noinline]] static void AddBranchProduct(const ChunkTask<S>& task, std::size_t b, int q,
                                                 const PointBlock<S>& point, const BlockMatrix<S>& dF,
                                                 BlockMatrix<S>& dP) {
    PointBlock<S> passive;
    SetPassive(point, passive);
    BlockMatrix<S> of_law;
    LawList<L, Material>::kKernels[task.law_kind].product(task.branch_law, passive, dF, of_law);
    for (int k = 0; k < kBlock; k += L::kLanes) {
      const Matrix3<L> B = LoadSymmetric(BranchStressAt(task, b, q), k);
      const Matrix3<L> added = task.branch_factor * LoadMatrix<L>(of_law.m, k) + LoadMatrix<L>(dF.m, k) * B;
      StoreMatrix(LoadMatrix<L>(dP.m, k) + added, k, dP.m);
    }
  }
  // Adds their tangent.
  [[gnu::noinline]] static void AddBranchTangent(const ChunkTask<S>& task, std::size_t b, int q,
                                                 const PointBlock<S>& point, S (*H)[kBlock]) {
    PointBlock<S> passive;
    SetPassive(point, passive);
    alignas(64) S of_law[TangentMatrix<L>::kEntries][kBlock];
    LawList<L, Material>::kKernels[task.law_kind].tangent(task.branch_law, passive, of_law);
    for (int k = 0; k < kBlock; k += L::kLanes) {
      TangentMatrix<L> terms;
      for (int i = 0; i < TangentMatrix<L>::kEntries; ++i) {
        terms.Set(i, L::Load(&H[i][k]) + task.branch_factor * L::Load(&of_law[i][k]));
      }
      terms.Right(LoadSymmetric(BranchStressAt(task, b, q), k));
      for (int i = 0; i < TangentMatrix<L>::kEntries; ++i) terms[i].Store(&H[i][k]);
    }
  }
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_KERNEL_BRANCHES_H_
