#ifndef FASCICLE_CORE_TET_KERNELS_IMPL_H_
#define FASCICLE_CORE_TET_KERNELS_IMPL_H_

#include <utility>

#include "core/base/lanes.h"
#include "core/materials/material.h"
#include "core/tet/kernels.h"
#include "core/tet/shape_functions.h"

// Implements kernels.h for one type of Lanes. Included by exactly one file for each instruction set. All functions here
// are templates on the Lanes type, so that two sets share none of them (a test inspects the object files). Calls
// nothing of Eigen or the standard library.
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

// Transposes rows (x, y, z, w) of four numbers to vectors of x, y, z and w, and back, as many rows at once as a vector
// has lanes (but at least four). What is stored here is loaded elsewhere as whole vectors; a load that spans several
// stores would stall until they have left the store buffer.
template <class L>
struct Rows {
  using S = typename L::Scalar;
  static constexpr int kWidth = L::kLanes < 4 ? 4 : L::kLanes;
  static constexpr int kGroups = kWidth / 4;
  typedef S Row __attribute__((vector_size(4 * sizeof(S))));
  typedef S Wide __attribute__((vector_size(kWidth * sizeof(S))));

  template <class Vector>
  static Vector Load(const S* p) {
    Vector r;
    __builtin_memcpy(&r, p, sizeof r);
    return r;
  }
  template <class Vector>
  static void Store(const Vector& r, S* p) {
    __builtin_memcpy(p, &r, sizeof r);
  }

  // The rows of nodes first, first + 4, first + 8 and so on, side by side.
  static Wide Join(const S* rows, const std::uint16_t* first) {
    const auto row = [&](int group) { return Load<Row>(rows + 4 * std::size_t{first[4 * group]}); };
    if constexpr (kGroups == 1) {
      return row(0);
    } else if constexpr (kGroups == 2) {
      return __builtin_shufflevector(row(0), row(1), 0, 1, 2, 3, 4, 5, 6, 7);
    } else {
      const auto low = __builtin_shufflevector(row(0), row(1), 0, 1, 2, 3, 4, 5, 6, 7);
      const auto high = __builtin_shufflevector(row(2), row(3), 0, 1, 2, 3, 4, 5, 6, 7);
      return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    }
  }
  template <int kGroup>
  static Row Part(const Wide& r) {
    if constexpr (kGroups == 1) {
      return r;
    } else {
      return __builtin_shufflevector(r, r, 4 * kGroup, 4 * kGroup + 1, 4 * kGroup + 2, 4 * kGroup + 3);
    }
  }

  // Numbers a, b, c, d of each group of four of x; 4 to 7 select those of y.
  template <int a, int b, int c, int d, int... lane>
  static Wide Mix(const Wide& x, const Wide& y, std::integer_sequence<int, lane...>) {
    constexpr int kFrom[4] = {a, b, c, d};
    return __builtin_shufflevector(x, y,
                                   (lane - lane % 4 + kFrom[lane % 4] % 4 + (kFrom[lane % 4] < 4 ? 0 : kWidth))...);
  }
  template <int a, int b, int c, int d>
  static Wide Mix(const Wide& x, const Wide& y) {
    return Mix<a, b, c, d>(x, y, std::make_integer_sequence<int, kWidth>());
  }

  // Transposes each group of four.
  static void Transpose(Wide r[4]) {
    if constexpr (sizeof(S) == 8) {
      const Wide a = Mix<0, 4, 2, 6>(r[0], r[1]), b = Mix<1, 5, 3, 7>(r[0], r[1]);
      const Wide c = Mix<0, 4, 2, 6>(r[2], r[3]), d = Mix<1, 5, 3, 7>(r[2], r[3]);
      r[0] = Mix<0, 1, 4, 5>(a, c);
      r[1] = Mix<0, 1, 4, 5>(b, d);
      r[2] = Mix<2, 3, 6, 7>(a, c);
      r[3] = Mix<2, 3, 6, 7>(b, d);
    } else {
      const Wide a = Mix<0, 4, 1, 5>(r[0], r[1]), b = Mix<0, 4, 1, 5>(r[2], r[3]);
      const Wide c = Mix<2, 6, 3, 7>(r[0], r[1]), d = Mix<2, 6, 3, 7>(r[2], r[3]);
      r[0] = Mix<0, 1, 4, 5>(a, b);
      r[1] = Mix<2, 3, 6, 7>(a, b);
      r[2] = Mix<0, 1, 4, 5>(c, d);
      r[3] = Mix<2, 3, 6, 7>(c, d);
    }
  }
};

template <class L, class Shape>
struct ChunkKernels {
  using S = typename L::Scalar;
  using R = Rows<L>;
  using Row = typename R::Row;
  using Wide = typename R::Wide;
  static constexpr int kNodes = Shape::kNodes, kPoints = Shape::kPoints;
  static constexpr bool kIsHexahedron = kNodes == 8;

  // The slopes of the shape functions of a hexahedron, dN_a/dxi_d at point q.
  struct SlopeTable {
    constexpr SlopeTable() {
      if constexpr (kIsHexahedron) {
        for (int q = 0; q < kPoints; ++q) {
          for (int a = 0; a < kNodes; ++a) {
            for (int d = 0; d < 3; ++d) at[q][a][d] = Shape::Slope(q, a, d);
          }
        }
      }
    }
    double at[kIsHexahedron ? kPoints : 1][kIsHexahedron ? kNodes : 1][3] = {};
  };
  static const double* SlopesOf(int q, int a) {
    static constexpr SlopeTable kTable;
    return kTable.at[q][a];
  }

  // Rows of the nodes of a chunk.
  struct alignas(64) NodeRows {
    S at[4 * kChunkNodes];
  };
  // Rows of the nodes of a block's elements, side by side.
  struct alignas(64) NodeValues {
    S at[kNodes][4][kBlock];
  };

  // `values` of the chunk's nodes minus `origin`; the fourth number is that of the node's patch, if any.
  static void LoadRows(const ChunkTask<S>& task, const double* values, const double* origin, const double* of_patch,
                       NodeRows& rows) {
    for (std::size_t i = 0; i < task.node_count; ++i) {
      const double* value = values + 3 * task.nodes[i];
      const bool has_patch = of_patch != nullptr && task.patch[i] != Sharing::kNone;
      const S fourth = has_patch ? static_cast<S>(of_patch[task.patch[i]]) : S(0);
      const Row row = {static_cast<S>(value[0] - origin[0]), static_cast<S>(value[1] - origin[1]),
                       static_cast<S>(value[2] - origin[2]), fourth};
      R::Store(row, rows.at + 4 * i);
    }
  }
  // Positions of a chunk are relative to its first node: in float, no digits are lost to the distance from the origin.
  static void LoadPositions(const ChunkTask<S>& task, const double* x, const double* of_patch, NodeRows& rows) {
    constexpr double kZero[3] = {0, 0, 0};
    LoadRows(task, x, sizeof(S) == 4 ? x + 3 * task.nodes[0] : kZero, of_patch, rows);
  }
  static void LoadVectors(const ChunkTask<S>& task, const double* v, const double* of_patch, NodeRows& rows) {
    constexpr double kZero[3] = {0, 0, 0};
    LoadRows(task, v, kZero, of_patch, rows);
  }

  static void Gather(const NodeRows& rows, const std::uint16_t* local, NodeValues& values) {
    for (int a = 0; a < kNodes; ++a) {
      for (int k = 0; k < kBlock; k += R::kWidth) {
        const std::uint16_t* node = local + a * kBlock + k;
        Wide r[4] = {R::Join(rows.at, node), R::Join(rows.at, node + 1), R::Join(rows.at, node + 2),
                     R::Join(rows.at, node + 3)};
        R::Transpose(r);
        for (int c = 0; c < 4; ++c) R::Store(r[c], &values.at[a][c][k]);
      }
    }
  }
  // Adds components 0 to 2, element by element and node by node, independently of the number of lanes.
  static void Scatter(const NodeValues& values, const std::uint16_t* local, NodeRows& rows) {
    for (int k = 0; k < kBlock; k += R::kWidth) {
      Wide r[kNodes][4];
      for (int a = 0; a < kNodes; ++a) {
        for (int c = 0; c < 3; ++c) r[a][c] = R::template Load<Wide>(&values.at[a][c][k]);
        r[a][3] = Wide{};
        R::Transpose(r[a]);
      }
      AddGroup<0>(r, local + k, rows);
      if constexpr (R::kGroups > 1) AddGroup<1>(r, local + k + 4, rows);
      if constexpr (R::kGroups > 2) {
        AddGroup<2>(r, local + k + 8, rows);
        AddGroup<3>(r, local + k + 12, rows);
      }
    }
  }
  template <int kGroup>
  static void AddGroup(const Wide (&r)[kNodes][4], const std::uint16_t* local, NodeRows& rows) {
    for (int lane = 0; lane < 4; ++lane) {
      for (int a = 0; a < kNodes; ++a) {
        S* row = rows.at + 4 * std::size_t{local[a * kBlock + lane]};
        R::Store(R::template Load<Row>(row) + R::template Part<kGroup>(r[a][lane]), row);
      }
    }
  }

  // The fourth number of the nodes of a hexahedron is that of its patch, if any, in the place of its first node.
  static void SetPatchValues(const ChunkTask<S>& task, const double* of_patch, std::size_t b, NodeValues& values) {
    if constexpr (kIsHexahedron) {
      if (of_patch == nullptr) return;
      const std::int32_t* patch = task.element_patch + b * kBlock;
      for (int k = 0; k < kBlock; ++k) {
        values.at[0][3][k] = patch[k] != Sharing::kNone ? static_cast<S>(of_patch[patch[k]]) : S(0);
      }
    }
  }

  // sum_a x_a (x) dN_a/dxi at point q of a hexahedron.
  static Matrix3<L> HexahedralEdges(const NodeValues& values, int q, int k) {
    Matrix3<L> edges;
    for (int i = 0; i < 3; ++i) {
      L sum[3] = {0.0, 0.0, 0.0};
      for (int a = 0; a < kNodes; ++a) {
        const L x = L::Load(&values.at[a][i][k]);
        const double* slope = SlopesOf(q, a);
        for (int d = 0; d < 3; ++d) sum[d] += slope[d] * x;
      }
      for (int d = 0; d < 3; ++d) edges(i, d) = sum[d];
    }
    return edges;
  }

  // [y1 - y0, y2 - y0, y3 - y0] of the corners y at point q.
  static Matrix3<L> Edges(const NodeValues& values, int q, int k) {
    if constexpr (kIsHexahedron) return HexahedralEdges(values, q, k);
    Matrix3<L> edges;
    for (int i = 0; i < 3; ++i) {
      L y[4];
      for (int c = 0; c < 4; ++c) y[c] = L::Load(&values.at[c][i][k]);
      if constexpr (kNodes == 10) {
        for (int c = 0; c < 4; ++c) y[c] *= 4 * Shape::Barycentric(q, c) - 1;
        for (int e = 0; e < 6; ++e) {
          const int a = kEdgeEnds[e][0], b = kEdgeEnds[e][1];
          const L middle = L::Load(&values.at[4 + e][i][k]);
          y[a] += 4 * Shape::Barycentric(q, b) * middle;
          y[b] += 4 * Shape::Barycentric(q, a) * middle;
        }
      }
      for (int c = 0; c < 3; ++c) edges(i, c) = y[c + 1] - y[0];
    }
    return edges;
  }
  static Matrix3<L> Gradient(const NodeValues& values, const RestPoint<S>& rest, int q, int k) {
    return Edges(values, q, k) * LoadMatrix<L>(rest.Dm_inverse, k);
  }

  // Adds the contribution of corner c at point q, component i, to the nodes.
  static void AddCorner(const L& value, int q, int c, int i, int k, NodeValues& nodes) {
    const auto add = [&](int a, const L& part) { (L::Load(&nodes.at[a][i][k]) + part).Store(&nodes.at[a][i][k]); };
    if constexpr (kNodes == 4) {
      add(c, value);
    } else {
      add(c, (4 * Shape::Barycentric(q, c) - 1) * value);
      for (int e = 0; e < 6; ++e) {
        if (kEdgeEnds[e][0] == c) add(4 + e, 4 * Shape::Barycentric(q, kEdgeEnds[e][1]) * value);
        if (kEdgeEnds[e][1] == c) add(4 + e, 4 * Shape::Barycentric(q, kEdgeEnds[e][0]) * value);
      }
    }
  }
  // Adds the corner forces [f1 f2 f3] = -V P Dm^-T, f0 = -(f1 + f2 + f3), to the nodes.
  static void AddForces(const Matrix3<L>& P, const RestPoint<S>& rest, int q, int k, NodeValues& nodes) {
    const Matrix3<L> f = (-L::Load(&rest.volume[k]) * P) * ::fascicle::Transpose(LoadMatrix<L>(rest.Dm_inverse, k));
    if constexpr (kIsHexahedron) {
      for (int a = 0; a < kNodes; ++a) {
        const double* slope = SlopesOf(q, a);
        for (int i = 0; i < 3; ++i) {
          const L part = slope[0] * f(i, 0) + slope[1] * f(i, 1) + slope[2] * f(i, 2);
          (L::Load(&nodes.at[a][i][k]) + part).Store(&nodes.at[a][i][k]);
        }
      }
    } else {
      AddCornerForces(f, q, k, nodes);
    }
  }
  static void AddCornerForces(const Matrix3<L>& f, int q, int k, NodeValues& nodes) {
    for (int i = 0; i < 3; ++i) {
      const L corners[4] = {-(f(i, 0) + f(i, 1) + f(i, 2)), f(i, 0), f(i, 1), f(i, 2)};
      for (int c = 0; c < 4; ++c) {
        if constexpr (kNodes == 4) {
          corners[c].Store(&nodes.at[c][i][k]);
        } else {
          AddCorner(corners[c], q, c, i, k, nodes);
        }
      }
    }
  }
  static void Clear(NodeValues& nodes) {
    for (int a = 0; a < kNodes; ++a) {
      for (int c = 0; c < 4; ++c) {
        for (int k = 0; k < kBlock; ++k) nodes.at[a][c][k] = 0;
      }
    }
  }

  // The fourth number at point q: the pressure of the patches.
  static L FourthAt(const NodeValues& values, int q, int k) {
    if constexpr (kIsHexahedron) return L::Load(&values.at[0][3][k]);
    L sum = 0.0;
    for (int c = 0; c < Shape::kPatches; ++c) sum += Shape::PatchWeight(q, c) * L::Load(&values.at[c][3][k]);
    return sum;
  }

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
      const Matrix3<L> F = Gradient(previous, rest, q, k);
      const Vector3<L> a = F * LoadVector<L>(point.fibres->direction, k);
      (Sqrt(Dot(a, a)) * InverseCubeRoot(Determinant(F))).Store(&point.previous_stretch[k]);
    }
  }

  // The strain E of the viscous stress.
  static Matrix3<L> StrainOf(const ChunkTask<S>& task, const Matrix3<L>& F, const NodeValues& other,
                             const RestPoint<S>& rest, int q, int k) {
    const Matrix3<L> G = Gradient(other, rest, q, k);
    if (task.v != nullptr) return SymmetricPart(::fascicle::Transpose(F) * G);
    return 0.5 * (::fascicle::Transpose(F) * F - ::fascicle::Transpose(G) * G);
  }
  static Matrix3<L> ViscousStress(const ChunkTask<S>& task, const Matrix3<L>& E) {
    return PlusDiagonal(2 * task.mu * E, task.lambda * Trace(E));
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
    const bool needs_previous = HasRate(task) || (IsViscous(task) && task.v == nullptr);
    const bool viscous = IsViscous(task);
    LoadPositions(task, task.x, task.pressure, x);
    NodeRows& before = other;
    NodeRows velocity;
    if (needs_previous) LoadPositions(task, task.previous, nullptr, before);
    if (viscous && task.v != nullptr) LoadVectors(task, task.v, nullptr, velocity);
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
        Prefetch(task, next + kBlocksAhead);
        const std::uint16_t* local = task.local + next * kNodes * kBlock;
        Gather(x, local, positions[at]);
        SetPatchValues(task, task.pressure, next, positions[at]);
        if (needs_previous) Gather(before, local, previous[at]);
        if (viscous && task.v != nullptr) Gather(velocity, local, rates[at]);
        for (int q = 0; q < kPoints; ++q) {
          PointBlock<S>& point = points[at][q];
          const RestPoint<S>& rest = task.points[kPoints * next + q];
          if (task.law != nullptr) SetActivation(task, task.fibres[next], point);
          for (int k = 0; k < kBlock; k += L::kLanes) {
            StoreMatrix(Gradient(positions[at], rest, q, k), k, point.F.m);
          }
          if (HasRate(task)) SetPreviousStretch(previous[at], rest, q, point);
        }
      }
      if (next > 0) {
        const std::size_t b = next - 1;
        const int at = b % 2;
        if (kNodes != 4) Clear(forces);
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
              if (task.pressure != nullptr) total = total + FourthAt(positions[at], q, k) * cofactor;
            }
            const L volume = L::Load(&rest.volume[k]);
            if (task.with_energy) energy.Add(k, volume * L::Load(&density[q][k]));
            if (viscous) {
              const Matrix3<L> E = StrainOf(task, F, task.v != nullptr ? rates[at] : previous[at], rest, q, k);
              const Matrix3<L> stress = ViscousStress(task, E);
              total = total + F * stress;
              power.Add(k, volume * Contract(stress, E));
            }
            AddForces(total, rest, q, k, forces);
          }
        }
        if (task.with_energy) AddSquares(forces, squares);
        Scatter(forces, task.local + b * kNodes * kBlock, sums);
      }
      for (int q = 0; q < kPoints && next < blocks; ++q) {
        const PointBlock<S>& point = points[next % 2][q];
        if (task.law != nullptr) law.stress(task.law, point, P[q]);
        if (task.with_energy) law.energy(task.law, point, density[q]);
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
  // Sums over the points of hexahedra, for their patches.
  template <class AtPoint>
  static void WritePatchVolumes(const ChunkTask<S>& task, const AtPoint& at_point, std::size_t b) {
    alignas(64) S volumes[kBlock];
    for (int k = 0; k < kBlock; k += L::kLanes) {
      L sum = 0.0;
      for (int q = 0; q < kPoints; ++q) sum += at_point(q, k);
      sum.Store(&volumes[k]);
    }
    const int elements = ElementsOf(task, b);
    for (int lane = 0; lane < elements; ++lane) task.sums[task.element_patch[b * kBlock + lane]] = volumes[lane];
  }
  static int ElementsOf(const ChunkTask<S>& task, std::size_t b) {
    const std::size_t left = task.elements - b * kBlock;
    return left < kBlock ? static_cast<int>(left) : kBlock;
  }
  // The volume at a point is det Ds / 6 times its weight.
  static constexpr double kVolumePerEdges = 1.0 / (6 * kPoints);

  [[gnu::flatten]] static void CornerVolumes(const ChunkTask<S>& task) {
    NodeRows x;
    alignas(64) S sums[kChunkNodes];
    LoadPositions(task, task.x, nullptr, x);
    for (std::size_t i = 0; i < task.node_count; ++i) sums[i] = 0;
    NodeValues positions;
    for (std::size_t b = 0; b * kBlock < task.elements; ++b) {
      const std::uint16_t* local = task.local + b * kNodes * kBlock;
      Gather(x, local, positions);
      const auto at_point = [&](int q, int k) { return kVolumePerEdges * Determinant(Edges(positions, q, k)); };
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
    LoadPositions(task, task.x, nullptr, x);
    LoadVectors(task, task.p, nullptr, p);
    for (std::size_t i = 0; i < task.node_count; ++i) sums[i] = 0;
    NodeValues positions, changes;
    for (std::size_t b = 0; b * kBlock < task.elements; ++b) {
      const std::uint16_t* local = task.local + b * kNodes * kBlock;
      Gather(x, local, positions);
      Gather(p, local, changes);
      const auto at_point = [&](int q, int k) {
        return kVolumePerEdges * Contract(Cofactor(Edges(positions, q, k)), Edges(changes, q, k));
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
    LoadPositions(task, task.x, task.pressure, x);
    LoadVectors(task, task.p, task.pressure_change, p);
    for (std::size_t i = 0; i < 4 * task.node_count; ++i) sums.at[i] = 0;
    NodeValues positions, changes, forces;
    PointBlock<S> point;
    BlockMatrix<S> dF, dP;
    const LawKernels<S>& law = LawList<L, Material>::kKernels[task.law_kind];
    for (std::size_t b = 0; b * kBlock < task.elements; ++b) {
      Prefetch(task, b + kBlocksAhead);
      const std::uint16_t* local = task.local + b * kNodes * kBlock;
      Gather(x, local, positions);
      Gather(p, local, changes);
      SetPatchValues(task, task.pressure, b, positions);
      SetPatchValues(task, task.pressure_change, b, changes);
      if (kNodes != 4) Clear(forces);
      SetActivation(task, task.fibres[b], point);
      for (int q = 0; q < kPoints; ++q) {
        const RestPoint<S>& rest = task.points[kPoints * b + q];
        for (int k = 0; k < kBlock; k += L::kLanes) {
          const Vector3<L> a0 = LoadVector<L>(point.fibres->direction, k);
          StoreMatrix(PerturbAlongFibre(Gradient(positions, rest, q, k), a0), k, point.F.m);
          StoreMatrix(Gradient(changes, rest, q, k), k, dF.m);
        }
        law.product(task.law, point, dF, dP);
        for (int k = 0; k < kBlock; k += L::kLanes) {
          Matrix3<L> total = LoadMatrix<L>(dP.m, k);
          if (task.pressure != nullptr) {
            const Matrix3<L> F = LoadMatrix<L>(point.F.m, k);
            TangentProduct<L> terms(LoadMatrix<L>(dF.m, k));
            terms.CofactorTerm(FourthAt(positions, q, k), F);
            total = total + terms.dP() + FourthAt(changes, q, k) * Cofactor(F);
          }
          AddForces(-1 * total, rest, q, k, forces);
        }
      }
      Scatter(forces, local, sums);
    }
    WriteVectors(task, sums);
  }

  // Weight of a node in the corners of the linear tetrahedra: a corner node enters one corner, a mid-edge node two.
  struct Parts {
    int count = 0;
    int corner[2] = {};
    double factor[kPoints][2] = {};
  };
  struct PartTable {
    constexpr PartTable() {
      for (int a = 0; a < kNodes; ++a) {
        Parts& parts = of[a];
        parts.count = a < 4 ? 1 : 2;
        for (int i = 0; i < parts.count; ++i) {
          parts.corner[i] = a < 4 ? a : kEdgeEnds[a - 4][i];
          for (int q = 0; q < kPoints; ++q) {
            parts.factor[q][i] = Shape::CornerWeight(q, parts.corner[i], a);
          }
        }
      }
    }
    Parts of[kNodes];
  };
  static constexpr int kPairs = kNodes * (kNodes + 1) / 2;
  static constexpr int PairOf(int a, int b) { return a * (a + 1) / 2 + b; }

  // The matrices of a block's elements, side by side.
  struct alignas(64) MatrixEntries {
    S of[kPairs][9][kBlock];
  };

  // The tangent H of a point under the whole potential.
  static TangentMatrix<L> TangentAt(const ChunkTask<S>& task, const S (*H)[kBlock], const Matrix3<L>& F,
                                    const NodeValues& positions, const NodeValues& previous, const RestPoint<S>& rest,
                                    int q, int k) {
    TangentMatrix<L> terms;
    for (int i = 0; i < TangentMatrix<L>::kEntries; ++i) terms.Set(i, L::Load(&H[i][k]));
    if (task.pressure != nullptr) terms.CofactorTerm(FourthAt(positions, q, k), F);
    if (IsViscous(task)) {
      terms.Square(task.lambda, F);
      terms.Right(ViscousStress(task, StrainOf(task, F, previous, rest, q, k)));
      terms.Transposed(task.mu, F);
      terms.Left(task.mu * (F * ::fascicle::Transpose(F)));
    }
    return terms;
  }

  // The blocks of the linear tetrahedron of one point, for corners c >= d at PairOf(c, d).
  static void SetCornerBlocks(const TangentMatrix<L>& H, const L& volume, const Matrix3<L>& Dm_inverse,
                              Matrix3<L> (&blocks)[10]) {
    for (int d = 1; d < 4; ++d) {
      // Derivative of P with respect to each component of corner d.
      Matrix3<L> change[3];
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
          for (int k = 0; k < 3; ++k) {
            L sum = 0.0;
            for (int l = 0; l < 3; ++l) {
              const int row = 3 * j + i, column = 3 * l + k;
              sum += H[row <= column ? H.At(row, column) : H.At(column, row)] * Dm_inverse(d - 1, l);
            }
            change[j](i, k) = volume * sum;
          }
        }
      }
      for (int c = d; c < 4; ++c) {
        blocks[PairOf(c, d)] =
            Dm_inverse(c - 1, 0) * change[0] + Dm_inverse(c - 1, 1) * change[1] + Dm_inverse(c - 1, 2) * change[2];
      }
    }
    // The gradients of all four corners sum to zero.
    for (int c = 1; c < 4; ++c) {
      Matrix3<L> sum = blocks[PairOf(c, c)];
      for (int d = 1; d < 4; ++d) {
        if (d != c) sum = sum + (d < c ? blocks[PairOf(c, d)] : ::fascicle::Transpose(blocks[PairOf(d, c)]));
      }
      blocks[PairOf(c, 0)] = -1 * sum;
    }
    blocks[0] = -1 * (blocks[PairOf(1, 0)] + blocks[PairOf(2, 0)] + blocks[PairOf(3, 0)]);
  }

  // Adds the blocks of one point of a hexahedron, node by node.
  static void AddHexahedralBlocks(const TangentMatrix<L>& H, const L& volume, const Matrix3<L>& Dm_inverse, int q,
                                  int k, MatrixEntries& entries) {
    // Rest gradients of the shape functions.
    L gradient[kNodes][3];
    for (int a = 0; a < kNodes; ++a) {
      const double* slope = SlopesOf(q, a);
      for (int l = 0; l < 3; ++l) {
        gradient[a][l] = slope[0] * Dm_inverse(0, l) + slope[1] * Dm_inverse(1, l) + slope[2] * Dm_inverse(2, l);
      }
    }
    for (int b = 0; b < kNodes; ++b) {
      // Derivative of P with respect to each component of node b.
      Matrix3<L> change[3];
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
          for (int m = 0; m < 3; ++m) {
            L sum = 0.0;
            for (int l = 0; l < 3; ++l) {
              const int row = 3 * j + i, column = 3 * l + m;
              sum += H[row <= column ? H.At(row, column) : H.At(column, row)] * gradient[b][l];
            }
            change[j](i, m) = volume * sum;
          }
        }
      }
      for (int a = b; a < kNodes; ++a) {
        S(*block)[kBlock] = entries.of[PairOf(a, b)];
        for (int m = 0; m < 9; ++m) {
          const L part =
              gradient[a][0] * change[0].m[m] + gradient[a][1] * change[1].m[m] + gradient[a][2] * change[2].m[m];
          (L::Load(&block[m][k]) + part).Store(&block[m][k]);
        }
      }
    }
  }

  static void Clear(MatrixEntries& entries) {
    for (int i = 0; i < kPairs; ++i) {
      for (int m = 0; m < 9; ++m) {
        for (int k = 0; k < kBlock; k += L::kLanes) L(0.0).Store(&entries.of[i][m][k]);
      }
    }
  }
  static void AddBlocks(const Matrix3<L> (&corner_blocks)[10], int q, int k, MatrixEntries& entries) {
    static constexpr PartTable kParts;
    if constexpr (kNodes == 4) {
      for (int pair = 0; pair < kPairs; ++pair) {
        for (int m = 0; m < 9; ++m) corner_blocks[pair].m[m].Store(&entries.of[pair][m][k]);
      }
      return;
    }
    for (int a = 0; a < kNodes; ++a) {
      for (int b = 0; b <= a; ++b) {
        S(*block)[kBlock] = entries.of[PairOf(a, b)];
        const Parts &of_a = kParts.of[a], &of_b = kParts.of[b];
        for (int i = 0; i < of_a.count; ++i) {
          for (int j = 0; j < of_b.count; ++j) {
            const int c = of_a.corner[i], d = of_b.corner[j];
            const L factor = of_a.factor[q][i] * of_b.factor[q][j];
            const Matrix3<L>& part = corner_blocks[c >= d ? PairOf(c, d) : PairOf(d, c)];
            for (int m = 0; m < 9; ++m) {
              const L& value = part.m[c >= d ? m : 3 * (m % 3) + m / 3];
              (L::Load(&block[m][k]) + factor * value).Store(&block[m][k]);
            }
          }
        }
      }
    }
  }

  // Transposes the matrices of the lanes whose bit is set.
  static void Turn(unsigned lanes, S (&block)[9][kBlock]) {
    if (lanes == 0) return;
    alignas(64) S is_turned[kBlock];
    for (int k = 0; k < kBlock; ++k) is_turned[k] = static_cast<S>(lanes >> k & 1);
    for (int k = 0; k < kBlock; k += L::kLanes) {
      const auto turned = L::Load(&is_turned[k]) > 0;
      constexpr int kMirrored[3][2] = {{1, 3}, {2, 6}, {5, 7}};
      for (const auto& [i, j] : kMirrored) {
        const L a = L::Load(&block[i][k]), b = L::Load(&block[j][k]);
        Select(turned, b, a).Store(&block[i][k]);
        Select(turned, a, b).Store(&block[j][k]);
      }
    }
  }

  // Adds a block's matrices to those of the chunk, nine numbers as four, four and one, pair by pair and element by
  // element, independently of the number of lanes. Unused lanes have zero volume.
  using Four = Rows<Lanes<S, typename L::Tag, 4>>;
  static void AddToChunk(MatrixEntries& entries, std::size_t b, const ChunkBlocks& chunk) {
    for (int pair = 0; pair < kPairs; ++pair) {
      const std::size_t at = kPairs * b + pair;
      S(&block)[9][kBlock] = entries.of[pair];
      Turn(chunk.turned[at], block);
      const std::uint16_t* place = chunk.place + kBlock * at;
      for (int first = 0; first < kBlock; first += 4) {
        Row low[4], high[4];
        for (int i = 0; i < 4; ++i) {
          low[i] = Four::template Load<Row>(&block[i][first]);
          high[i] = Four::template Load<Row>(&block[4 + i][first]);
        }
        Four::Transpose(low);
        Four::Transpose(high);
        for (int i = 0; i < 4; ++i) {
          S* to = reinterpret_cast<S*>(chunk.sums) + 9 * std::size_t{place[first + i]};
          Four::Store(Four::template Load<Row>(to) + low[i], to);
          Four::Store(Four::template Load<Row>(to + 4) + high[i], to + 4);
          to[8] += block[8][first + i];
        }
      }
    }
  }

  [[gnu::flatten]] static void Stiffness(const ChunkTask<S>& task, const ChunkBlocks& chunk) {
    NodeRows x, before;
    const bool needs_previous = HasRate(task) || IsViscous(task);
    LoadPositions(task, task.x, task.pressure, x);
    if (needs_previous) LoadPositions(task, task.previous, nullptr, before);
    NodeValues positions, previous;
    MatrixEntries entries;
    PointBlock<S> point;
    alignas(64) S H[TangentMatrix<L>::kEntries][kBlock];
    for (std::size_t b = 0; b * kBlock < task.elements; ++b) {
      Prefetch(task, b + kBlocksAhead);
      const std::uint16_t* local = task.local + b * kNodes * kBlock;
      Gather(x, local, positions);
      SetPatchValues(task, task.pressure, b, positions);
      if (needs_previous) Gather(before, local, previous);
      if (kNodes != 4) Clear(entries);
      SetActivation(task, task.fibres[b], point);
      for (int q = 0; q < kPoints; ++q) {
        const RestPoint<S>& rest = task.points[kPoints * b + q];
        for (int k = 0; k < kBlock; k += L::kLanes) StoreMatrix(Gradient(positions, rest, q, k), k, point.F.m);
        if (HasRate(task)) SetPreviousStretch(previous, rest, q, point);
        LawList<L, Material>::kKernels[task.law_kind].tangent(task.law, point, H);
        for (int k = 0; k < kBlock; k += L::kLanes) {
          const Matrix3<L> F = LoadMatrix<L>(point.F.m, k);
          if constexpr (kIsHexahedron) {
            AddHexahedralBlocks(TangentAt(task, H, F, positions, previous, rest, q, k), L::Load(&rest.volume[k]),
                                LoadMatrix<L>(rest.Dm_inverse, k), q, k, entries);
          } else {
            Matrix3<L> corner_blocks[10];
            SetCornerBlocks(TangentAt(task, H, F, positions, previous, rest, q, k), L::Load(&rest.volume[k]),
                            LoadMatrix<L>(rest.Dm_inverse, k), corner_blocks);
            AddBlocks(corner_blocks, q, k, entries);
          }
        }
      }
      AddToChunk(entries, b, chunk);
    }
  }
};

template <class L, class Shape>
constexpr ElementKernels<typename L::Scalar> ElementKernelsOf() {
  using K = ChunkKernels<L, Shape>;
  using S = typename L::Scalar;
  void (*stiffness)(const ChunkTask<S>&, const ChunkBlocks&) = nullptr;
  if constexpr (sizeof(S) == 8) stiffness = &K::Stiffness;
  return {&K::Forces, &K::CornerVolumes, &K::CornerVolumeChanges, &K::StiffnessProduct, stiffness};
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
          ElementKernelsOf<F, LinearShape>(),
          ElementKernelsOf<F, QuadraticShape>(),
          ElementKernelsOf<F, HexahedralShape>(),
          &PatchPressures<D>};
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_KERNELS_IMPL_H_
