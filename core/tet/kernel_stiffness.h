#ifndef FASCICLE_CORE_TET_KERNEL_STIFFNESS_H_
#define FASCICLE_CORE_TET_KERNEL_STIFFNESS_H_

#include "core/tet/kernel_branches.h"
#include "core/tet/kernel_points.h"

// Element matrices. Part of kernels_impl.h, with its rules: templates on the Lanes type only.
namespace fascicle {

// The tangent stiffness of a chunk's elements, block by block.
template <class L, class Shape>
struct StiffnessKernel {
  using S = typename L::Scalar;
  using Nodes = ElementNodes<L, Shape>;
  using Points = ElementPoints<L, Shape>;
  using Branches = ElementBranches<L, Shape>;
  using NodeRows = typename Nodes::NodeRows;
  using NodeValues = typename Nodes::NodeValues;
  using Row = typename Nodes::Row;
  static constexpr int kNodes = Shape::kNodes, kPoints = Shape::kPoints;

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
    if (task.pressure != nullptr) terms.CofactorTerm(Nodes::FourthAt(positions, q, k), F);
    if (Points::IsViscous(task)) {
      terms.Square(task.lambda, F);
      terms.Right(Points::ViscousStress(task, Points::StrainOf(task, F, previous, rest, q, k)));
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
      const double* slope = Nodes::SlopesOf(q, a);
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

  // Adds to the matrices of the lanes whose bit is set their transposes.
  static void AddTransposed(unsigned lanes, S (&block)[9][kBlock]) {
    if (lanes == 0) return;
    S sum[9][kBlock];
    for (int m = 0; m < 9; ++m) {
      for (int k = 0; k < kBlock; ++k) {
        sum[m][k] = (lanes >> k & 1) != 0 ? block[m][k] + block[3 * (m % 3) + m / 3][k] : block[m][k];
      }
    }
    for (int m = 0; m < 9; ++m) {
      for (int k = 0; k < kBlock; ++k) block[m][k] = sum[m][k];
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
      if (chunk.doubled != nullptr) AddTransposed(chunk.doubled[at], block);
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
    const bool needs_previous = Points::HasRate(task) || Points::IsViscous(task);
    Nodes::LoadPositions(task, task.x, task.pressure, x);
    if (needs_previous) Nodes::LoadPositions(task, task.previous, nullptr, before);
    NodeValues positions, previous;
    MatrixEntries entries;
    PointBlock<S> point;
    alignas(64) S H[TangentMatrix<L>::kEntries][kBlock];
    for (std::size_t b = 0; b * kBlock < task.elements; ++b) {
      Points::Prefetch(task, b + Points::kBlocksAhead);
      const std::uint16_t* local = task.local + b * kNodes * kBlock;
      Nodes::Gather(x, local, positions);
      Nodes::SetPatchValues(task, task.pressure, b, positions);
      if (needs_previous) Nodes::Gather(before, local, previous);
      if (kNodes != 4) Clear(entries);
      Points::SetActivation(task, task.fibres[b], point);
      for (int q = 0; q < kPoints; ++q) {
        const RestPoint<S>& rest = task.points[kPoints * b + q];
        for (int k = 0; k < kBlock; k += L::kLanes) StoreMatrix(Nodes::Gradient(positions, rest, q, k), k, point.F.m);
        if (Points::HasRate(task)) Points::SetPreviousStretch(previous, rest, q, point);
        LawList<L, Material>::kKernels[task.law_kind].tangent(task.law, point, H);
        if (Branches::HasBranches(task)) Branches::AddBranchTangent(task, b, q, point, H);
        for (int k = 0; k < kBlock; k += L::kLanes) {
          const Matrix3<L> F = LoadMatrix<L>(point.F.m, k);
          if constexpr (Shape::kIsHexahedron) {
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

}  // namespace fascicle

#endif  // FASCICLE_CORE_TET_KERNEL_STIFFNESS_H_
