#ifndef FASCICLE_CORE_TET_KERNELS_IMPL_H_
#define FASCICLE_CORE_TET_KERNELS_IMPL_H_

#include "core/tet/kernel_branches.h"
#include "core/tet/kernel_points.h"
#include "core/tet/kernel_stiffness.h"

// Implements kernels.h for one type of Lanes. Included by exactly one file for each instruction set. All functions here
// and in the files above are templates on the Lanes type, so that two sets share none of them (a test inspects the
// object files). Calls nothing of Eigen or the standard library.
namespace fascicle {

// Forces, volumes and stiffness products of a chunk.
template <class L, class Shape>
struct ChunkKernels {
  using S = typename L::Scalar;
  using Nodes = ElementNodes<L, Shape>;
  using Points = ElementPoints<L, Shape>;
  using Branches = ElementBranches<L, Shape>;
  using NodeRows = typename Nodes::NodeRows;
  using NodeValues = typename Nodes::NodeValues;
  static constexpr int kNodes = Shape::kNodes, kPoints = Shape::kPoints;
  static constexpr bool kIsHexahedron = Shape::kIsHexahedron;

  static void BranchStates(const ChunkTask<S>& task, double* values) {
    NodeRows x;
    Nodes::LoadPositions(task, task.x, nullptr, x);
    NodeValues positions;
    PointBlock<S> point;
    BlockMatrix<S> P;
    for (std::size_t b = 0; b * kBlock < task.elements; ++b) {
      Nodes::Gather(x, task.local + b * kNodes * kBlock, positions);
      for (int q = 0; q < kPoints; ++q) {
        const RestPoint<S>& rest = task.points[kPoints * b + q];
        for (int k = 0; k < kBlock; k += L::kLanes) {
          StoreMatrix(Nodes::Gradient(positions, rest, q, k), k, point.F.m);
        }
        point.fibres = &task.fibres[b];
        PointBlock<S> passive;
        Branches::SetPassive(point, passive);
        LawList<L, Material>::kKernels[task.law_kind].stress(task.branch_law, passive, P);
        double* const stress = values + 2 * kBranchTensor * (kPoints * b + q);
        for (int k = 0; k < kBlock; k += L::kLanes) {
          const Matrix3<L> F = LoadMatrix<L>(point.F.m, k);
          const Matrix3<L> cofactor = Cofactor(F);
          const L inverse_J = 1 / DeterminantOf(F, cofactor);
          Branches::StoreSymmetric(inverse_J * (::fascicle::Transpose(cofactor) * LoadMatrix<L>(P.m, k)), stress, k);
          Branches::StoreSymmetric(0.5 * PlusDiagonal(::fascicle::Transpose(F) * F, -1), stress + kBranchTensor, k);
        }
      }
    }
  }

  // Sums of a chunk by the lane of the block, so that their order does not depend on the number of lanes of a vector.
  struct alignas(64) LaneSums {
    S at[kBlock] = {};
    void Add(int k, const L& value) { (L::Load(&at[k]) + value).Store(&at[k]); }
    double Total() const {
      double total = 0;
      for (const S value : at) total += value;
      return total;
    }
  };

  [[gnu::flatten]] static ChunkReport Forces(const ChunkTask<S>& task) {
    NodeRows x, other, sums;
    const bool needs_previous = Points::HasRate(task) || (Points::IsViscous(task) && task.v == nullptr);
    const bool viscous = Points::IsViscous(task);
    Nodes::LoadPositions(task, task.x, task.pressure, x);
    NodeRows& before = other;
    NodeRows velocity;
    if (needs_previous) Nodes::LoadPositions(task, task.previous, nullptr, before);
    if (viscous && task.v != nullptr) Nodes::LoadVectors(task, task.v, nullptr, velocity);
    for (std::size_t i = 0; i < 4 * task.node_count; ++i) sums.at[i] = 0;

    LaneSums power, energy, squares, not_finite;
    alignas(64) S smallest[kBlock];
    for (S& s : smallest) s = 1;
    // Two blocks are in flight: F of the next block is computed before the forces of this one, which wait for its law,
    // are added up.
    NodeValues positions[2], previous[2], rates[2];
    PointBlock<S> points[2][kPoints];
    BlockMatrix<S> P[kPoints];
    alignas(64) S density[kPoints][kBlock];
    NodeValues forces;
    const std::size_t blocks = (task.elements + kBlock - 1) / kBlock;
    const LawKernels<S>& law = LawList<L, Material>::kKernels[task.law_kind];
    for (std::size_t next = 0; next <= blocks; ++next) {
      if (next < blocks) {
        const int at = next % 2;
        Points::Prefetch(task, next + Points::kBlocksAhead);
        const std::uint16_t* local = task.local + next * kNodes * kBlock;
        Nodes::Gather(x, local, positions[at]);
        Nodes::SetPatchValues(task, task.pressure, next, positions[at]);
        if (needs_previous) Nodes::Gather(before, local, previous[at]);
        if (viscous && task.v != nullptr) Nodes::Gather(velocity, local, rates[at]);
        for (int q = 0; q < kPoints; ++q) {
          PointBlock<S>& point = points[at][q];
          const RestPoint<S>& rest = task.points[kPoints * next + q];
          if (task.law != nullptr) Points::SetActivation(task, task.fibres[next], point);
          for (int k = 0; k < kBlock; k += L::kLanes) {
            StoreMatrix(Nodes::Gradient(positions[at], rest, q, k), k, point.F.m);
          }
          if (Points::HasRate(task)) Points::SetPreviousStretch(previous[at], rest, q, point);
        }
      }
      if (next > 0) {
        const std::size_t b = next - 1;
        const int at = b % 2;
        if (kNodes != 4) Nodes::Clear(forces);
        for (int q = 0; q < kPoints; ++q) {
          const RestPoint<S>& rest = task.points[kPoints * b + q];
          for (int k = 0; k < kBlock; k += L::kLanes) {
            const Matrix3<L> F = LoadMatrix<L>(points[at][q].F.m, k);
            Matrix3<L> total = Diagonal(L(0.0));
            if (task.law != nullptr) {
              const Matrix3<L> cofactor = Cofactor(F);
              const L J = DeterminantOf(F, cofactor);
              const L least = L::Load(&smallest[k]);
              Select(J < least, J, least).Store(&smallest[k]);
              not_finite.Add(k, J * 0);
              total = LoadMatrix<L>(P[q].m, k);
              if (task.pressure != nullptr) total = total + Nodes::FourthAt(positions[at], q, k) * cofactor;
            }
            const L volume = L::Load(&rest.volume[k]);
            if (task.with_energy) energy.Add(k, volume * L::Load(&density[q][k]));
            if (viscous) {
              const Matrix3<L> E = Points::StrainOf(task, F, task.v != nullptr ? rates[at] : previous[at], rest, q, k);
              const Matrix3<L> stress = Points::ViscousStress(task, E);
              total = total + F * stress;
              power.Add(k, volume * Contract(stress, E));
            }
            Nodes::AddForces(total, rest, q, k, forces);
          }
        }
        if (task.with_energy) AddSquares(forces, squares);
        Nodes::Scatter(forces, task.local + b * kNodes * kBlock, sums);
      }
      for (int q = 0; q < kPoints && next < blocks; ++q) {
        const PointBlock<S>& point = points[next % 2][q];
        if (task.law != nullptr) law.stress(task.law, point, P[q]);
        if (task.with_energy) law.energy(task.law, point, density[q]);
        if (Branches::HasBranches(task)) Branches::AddBranches(task, next, q, point, P[q], density[q]);
      }
    }
    ChunkReport report;
    report.finite = WriteVectors(task, sums);
    for (const S s : smallest) {
      if (s < report.smallest_ratio) report.smallest_ratio = s;
    }
    if (not_finite.Total() != 0) report.smallest_ratio = not_finite.Total();
    report.dissipated_power = power.Total();
    report.energy = energy.Total() + (task.with_energy ? 0.5 * report.dissipated_power : 0);
    report.squares = squares.Total();
    return report;
  }

  static void AddSquares(const NodeValues& forces, LaneSums& squares) {
    for (int k = 0; k < kBlock; k += L::kLanes) {
      L sum = 0.0;
      for (int a = 0; a < kNodes; ++a) {
        const Vector3<L> f = LoadVector<L>(forces.at[a], k);
        sum += Dot(f, f);
      }
      squares.Add(k, sum);
    }
  }

  // Writes the chunk's sums to their targets; returns whether all are finite.
  static bool WriteVectors(const ChunkTask<S>& task, const NodeRows& sums) {
    double check = 0;
    for (std::size_t i = 0; i < task.node_count; ++i) {
      const S* row = sums.at + 4 * i;
      check += static_cast<double>(row[0] + row[1] + row[2]) * 0;
      if (task.sums == nullptr) continue;
      const std::int32_t target = task.target[i];
      double* to = target >= 0 ? task.sums + 3 * std::ptrdiff_t{target} : task.slot_sums + 3 * std::ptrdiff_t{~target};
      for (int c = 0; c < 3; ++c) to[c] = row[c];
    }
    return check == 0;
  }
  static void WriteNumbers(const ChunkTask<S>& task, const S* sums) {
    for (std::size_t i = 0; i < task.node_count; ++i) {
      const std::int32_t target = task.target[i];
      if (target == Sharing::kNone) continue;
      (target >= 0 ? task.sums[target] : task.slot_sums[~target]) = sums[i];
    }
  }

  // Adds the corner volumes from `at_point(q, lane)`, the volume at each point.
  template <class AtPoint>
  static void AddCornerVolumes(const AtPoint& at_point, const std::uint16_t* local, int elements, S* sums) {
    alignas(64) S volumes[4][kBlock];
    for (int k = 0; k < kBlock; k += L::kLanes) {
      if constexpr (kPoints == 1) {
        const L volume = at_point(0, k) * 0.25;
        for (int c = 0; c < 4; ++c) volume.Store(&volumes[c][k]);
      } else {
        L sum[4] = {0.0, 0.0, 0.0, 0.0};
        for (int q = 0; q < kPoints; ++q) {
          const L volume = at_point(q, k);
          for (int c = 0; c < 4; ++c) sum[c] += Shape::Barycentric(q, c) * volume;
        }
        for (int c = 0; c < 4; ++c) sum[c].Store(&volumes[c][k]);
      }
    }
    for (int lane = 0; lane < elements; ++lane) {
      for (int c = 0; c < 4; ++c) sums[local[c * kBlock + lane]] += volumes[c][lane];
    }
  }
  // The same for the patches of hexahedra, which receive nothing from other elements.
  template <class AtPoint>
  static void WritePatchVolumes(const ChunkTask<S>& task, const AtPoint& at_point, std::size_t b) {
    alignas(64) S volumes[Shape::kPatches][kBlock];
    for (int k = 0; k < kBlock; k += L::kLanes) {
      L sum[Shape::kPatches];
      for (L& s : sum) s = 0.0;
      for (int q = 0; q < kPoints; ++q) {
        const L volume = at_point(q, k);
        for (int c = 0; c < Shape::kPatches; ++c) {
          sum[c] += Shape::kPatches == 1 ? volume : Nodes::PatchWeightsOf(q)[c] * volume;
        }
      }
      for (int c = 0; c < Shape::kPatches; ++c) sum[c].Store(&volumes[c][k]);
    }
    const int elements = ElementsOf(task, b);
    for (int lane = 0; lane < elements; ++lane) {
      double* const sums = task.sums + task.element_patch[b * kBlock + lane];
      for (int c = 0; c < Shape::kPatches; ++c) sums[c] = volumes[c][lane];
    }
  }
  static int ElementsOf(const ChunkTask<S>& task, std::size_t b) {
    const std::size_t left = task.elements - b * kBlock;
    return left < kBlock ? static_cast<int>(left) : kBlock;
  }
  // The volume at a point is det Ds / 6 times its weight.
  struct VolumeTable {
    constexpr VolumeTable() {
      for (int q = 0; q < kPoints; ++q) per_edges[q] = Shape::PointWeight(q) / 6;
    }
    double per_edges[kPoints] = {};
  };
  static double VolumePerEdges(int q) {
    static constexpr VolumeTable kTable;
    return kTable.per_edges[q];
  }

  [[gnu::flatten]] static void CornerVolumes(const ChunkTask<S>& task) {
    NodeRows x;
    alignas(64) S sums[kChunkNodes];
    Nodes::LoadPositions(task, task.x, nullptr, x);
    for (std::size_t i = 0; i < task.node_count; ++i) sums[i] = 0;
    NodeValues positions;
    for (std::size_t b = 0; b * kBlock < task.elements; ++b) {
      const std::uint16_t* local = task.local + b * kNodes * kBlock;
      Nodes::Gather(x, local, positions);
      const auto at_point = [&](int q, int k) {
        return VolumePerEdges(q) * Determinant(Nodes::Edges(positions, q, k));
      };
      if constexpr (kIsHexahedron) {
        WritePatchVolumes(task, at_point, b);
      } else {
        AddCornerVolumes(at_point, local, ElementsOf(task, b), sums);
      }
    }
    if (!kIsHexahedron) WriteNumbers(task, sums);
  }

  [[gnu::flatten]] static void CornerVolumeChanges(const ChunkTask<S>& task) {
    NodeRows x, p;
    alignas(64) S sums[kChunkNodes];
    Nodes::LoadPositions(task, task.x, nullptr, x);
    Nodes::LoadVectors(task, task.p, nullptr, p);
    for (std::size_t i = 0; i < task.node_count; ++i) sums[i] = 0;
    NodeValues positions, changes;
    for (std::size_t b = 0; b * kBlock < task.elements; ++b) {
      const std::uint16_t* local = task.local + b * kNodes * kBlock;
      Nodes::Gather(x, local, positions);
      Nodes::Gather(p, local, changes);
      const auto at_point = [&](int q, int k) {
        return VolumePerEdges(q) * Contract(Cofactor(Nodes::Edges(positions, q, k)), Nodes::Edges(changes, q, k));
      };
      if constexpr (kIsHexahedron) {
        WritePatchVolumes(task, at_point, b);
      } else {
        AddCornerVolumes(at_point, local, ElementsOf(task, b), sums);
      }
    }
    if (!kIsHexahedron) WriteNumbers(task, sums);
  }

  // F (I + e a0 a0^T) with a small e > 0. At a kink of a fibre curve, especially at rest, this selects the tangent of
  // the stiffer side.
  static Matrix3<L> PerturbAlongFibre(const Matrix3<L>& F, const Vector3<L>& a0) {
    constexpr double kPerturbation = sizeof(S) == 4 ? 1e-6 : 1e-7;
    return F + kPerturbation * ::fascicle::Outer(F * a0, a0);
  }

  [[gnu::flatten]] static void StiffnessProduct(const ChunkTask<S>& task) {
    NodeRows x, p, sums;
    Nodes::LoadPositions(task, task.x, task.pressure, x);
    Nodes::LoadVectors(task, task.p, task.pressure_change, p);
    for (std::size_t i = 0; i < 4 * task.node_count; ++i) sums.at[i] = 0;
    NodeValues positions, changes, forces;
    PointBlock<S> point;
    BlockMatrix<S> dF, dP;
    const LawKernels<S>& law = LawList<L, Material>::kKernels[task.law_kind];
    for (std::size_t b = 0; b * kBlock < task.elements; ++b) {
      Points::Prefetch(task, b + Points::kBlocksAhead);
      const std::uint16_t* local = task.local + b * kNodes * kBlock;
      Nodes::Gather(x, local, positions);
      Nodes::Gather(p, local, changes);
      Nodes::SetPatchValues(task, task.pressure, b, positions);
      Nodes::SetPatchValues(task, task.pressure_change, b, changes);
      if (kNodes != 4) Nodes::Clear(forces);
      Points::SetActivation(task, task.fibres[b], point);
      for (int q = 0; q < kPoints; ++q) {
        const RestPoint<S>& rest = task.points[kPoints * b + q];
        for (int k = 0; k < kBlock; k += L::kLanes) {
          const Vector3<L> a0 = LoadVector<L>(point.fibres->direction, k);
          StoreMatrix(PerturbAlongFibre(Nodes::Gradient(positions, rest, q, k), a0), k, point.F.m);
          StoreMatrix(Nodes::Gradient(changes, rest, q, k), k, dF.m);
        }
        law.product(task.law, point, dF, dP);
        if (Branches::HasBranches(task)) Branches::AddBranchProduct(task, b, q, point, dF, dP);
        for (int k = 0; k < kBlock; k += L::kLanes) {
          Matrix3<L> total = LoadMatrix<L>(dP.m, k);
          if (task.pressure != nullptr) {
            const Matrix3<L> F = LoadMatrix<L>(point.F.m, k);
            TangentProduct<L> terms(LoadMatrix<L>(dF.m, k));
            terms.CofactorTerm(Nodes::FourthAt(positions, q, k), F);
            total = total + terms.dP() + Nodes::FourthAt(changes, q, k) * Cofactor(F);
          }
          Nodes::AddForces(-1 * total, rest, q, k, forces);
        }
      }
      Nodes::Scatter(forces, local, sums);
    }
    WriteVectors(task, sums);
  }
};

template <class L, class Shape>
constexpr ElementKernels<typename L::Scalar> ElementKernelsOf() {
  using K = ChunkKernels<L, Shape>;
  using S = typename L::Scalar;
  void (*stiffness)(const ChunkTask<S>&, const ChunkBlocks&) = nullptr;
  void (*branch_states)(const ChunkTask<S>&, double*) = nullptr;
  if constexpr (sizeof(S) == 8) {
    stiffness = &StiffnessKernel<L, Shape>::Stiffness;
    branch_states = &K::BranchStates;
  }
  return {&K::Forces, &K::CornerVolumes, &K::CornerVolumeChanges, &K::StiffnessProduct, stiffness, branch_states};
}

template <class L>
void PatchPressures(std::size_t count, const double* modulus, const double* theta, double* pressure) {
  const auto pressure_of = [](const L& k, const L& ratio) { return k * Log(ratio) / ratio; };
  std::size_t n = 0;
  for (; n + L::kLanes <= count; n += L::kLanes) {
    pressure_of(L::Load(modulus + n), L::Load(theta + n)).Store(pressure + n);
  }
  if (n == count) return;
  double k[L::kLanes] = {}, ratio[L::kLanes] = {}, last[L::kLanes];
  for (std::size_t i = n; i < count; ++i) {
    k[i - n] = modulus[i];
    ratio[i - n] = theta[i];
  }
  pressure_of(L::Load(k), L::Load(ratio)).Store(last);
  for (std::size_t i = n; i < count; ++i) pressure[i] = last[i - n];
}

template <class Set>
constexpr Kernels KernelsOf() {
  using D = Lanes<double, Set>;
  using F = Lanes<float, Set>;
  return {ElementKernelsOf<D, LinearShape>(),
          ElementKernelsOf<D, QuadraticShape>(),
          ElementKernelsOf<D, HexahedralShape>(),
          ElementKernelsOf<D, HexahedralQuadraticShape>(),
          ElementKernelsOf<F, LinearShape>(),
          ElementKernelsOf<F, QuadraticShape>(),
          ElementKernelsOf<F, HexahedralShape>(),
          ElementKernelsOf<F, HexahedralQuadraticShape>(),
          &PatchPressures<D>};
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_KERNELS_IMPL_H_
