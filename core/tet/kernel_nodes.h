#ifndef FASCICLE_CORE_TET_KERNEL_NODES_H_
#define FASCICLE_CORE_TET_KERNEL_NODES_H_

#include <utility>

#include "core/base/lanes.h"
#include "core/base/matrix3.h"
#include "core/materials/tensor_algebra.h"
#include "core/tet/kernels.h"
#include "core/tet/shape_functions.h"

// Nodes of elements. Part of kernels_impl.h, with its rules: templates on the Lanes type only.
namespace fascicle {

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

// The nodes of a block's elements: their values are gathered from the rows of a chunk, and forces scattered to them;
// shape functions and patches.
template <class L, class Shape>
struct ElementNodes {
  using S = typename L::Scalar;
  using R = Rows<L>;
  using Row = typename R::Row;
  using Wide = typename R::Wide;
  static constexpr int kNodes = Shape::kNodes, kPoints = Shape::kPoints;
  static constexpr bool kIsHexahedron = Shape::kIsHexahedron;

  // The slopes of the shape functions of a hexahedron, dN_a/dxi_d at point q, and the weights of patches.
  struct SlopeTable {
    constexpr SlopeTable() {
      for (int q = 0; q < kPoints; ++q) {
        for (int c = 0; c < Shape::kPatches; ++c) patch[q][c] = Shape::PatchWeight(q, c);
        if constexpr (kIsHexahedron) {
          for (int a = 0; a < kNodes; ++a) {
            for (int d = 0; d < 3; ++d) at[q][a][d] = Shape::Slope(q, a, d);
          }
        }
      }
    }
    double at[kIsHexahedron ? kPoints : 1][kIsHexahedron ? kNodes : 1][3] = {};
    double patch[kPoints][Shape::kPatches] = {};
  };
  static const double* SlopesOf(int q, int a) {
    static constexpr SlopeTable kTable;
    return kTable.at[q][a];
  }
  static const double* PatchWeightsOf(int q) {
    static constexpr SlopeTable kTable;
    return kTable.patch[q];
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

  // The fourth numbers of the first nodes of a hexahedron are those of its patches, if any.
  static void SetPatchValues(const ChunkTask<S>& task, const double* of_patch, std::size_t b, NodeValues& values) {
    if constexpr (kIsHexahedron) {
      if (of_patch == nullptr) return;
      const std::int32_t* first = task.element_patch + b * kBlock;
      for (int c = 0; c < Shape::kPatches; ++c) {
        for (int k = 0; k < kBlock; ++k) {
          values.at[c][3][k] = first[k] != Sharing::kNone ? static_cast<S>(of_patch[first[k] + c]) : S(0);
        }
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
    if constexpr (Shape::kPatches == 1) return L::Load(&values.at[0][3][k]);
    L sum = 0.0;
    for (int c = 0; c < Shape::kPatches; ++c) sum += PatchWeightsOf(q)[c] * L::Load(&values.at[c][3][k]);
    return sum;
  }
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_KERNEL_NODES_H_
