#ifndef FASCICLE_CORE_VOXEL_KERNELS_IMPL_H_
#define FASCICLE_CORE_VOXEL_KERNELS_IMPL_H_

#include <cstddef>
#include <utility>

#include "core/base/lanes.h"
#include "core/voxel/kernels.h"

// Implements kernels.h for one type of Lanes. Included by exactly one file for each instruction set. All functions here
// are templates on the Lanes type, so that two sets share none of them (a test inspects the object files). Calls
// nothing of Eigen or the standard library.
//
// Lanes are consecutive voxels along i, so corners are read as they are stored. Sums and differences across a face of
// corners (eta, zeta) are computed once and serve the voxels on both sides; shifted by one lane they belong to the
// other side. On the way back, the two sides of a face are added first, in the same order for any number of lanes.
namespace fascicle {

// The lanes of `a` followed by those of `b`, starting at number kFirst; as many as a vector has.
template <int kFirst, class L, int... kIndex>
[[gnu::always_inline]] inline L LanesFrom(L a, L b, std::integer_sequence<int, kIndex...>) {
  return L::Of(__builtin_shufflevector(a.v, b.v, (kIndex + kFirst)...));
}
template <int kFirst, class L>
[[gnu::always_inline]] inline L LanesFrom(L a, L b) {
#if defined(__AVX512F__)
  // Compilers choose a permutation with indices in a register, which overwrites one of its inputs.
  if constexpr (L::kBytes == 64) {
    const auto low = (__m512i)a.v, high = (__m512i)b.v;
    if constexpr (sizeof(typename L::Scalar) == 8) {
      return L::Of((typename L::Vector)_mm512_alignr_epi64(high, low, kFirst));
    } else {
      return L::Of((typename L::Vector)_mm512_alignr_epi32(high, low, kFirst));
    }
  }
#endif
  return LanesFrom<kFirst>(a, b, std::make_integer_sequence<int, L::kLanes>());
}
// Lanes 1, 2, ... of `a`, then the first of `b`.
template <class L>
[[gnu::always_inline]] inline L NextLanes(L a, L b) {
  return LanesFrom<1>(a, b);
}
// The last lane of `a`, then those of `b` except for its last.
template <class L>
[[gnu::always_inline]] inline L PreviousLanes(L a, L b) {
  return LanesFrom<L::kLanes - 1>(a, b);
}

// 0, 1, 2, ...
template <class L>
struct LaneNumbers {
  typename L::Scalar n[L::kLanes] = {};
  constexpr LaneNumbers() {
    for (int k = 0; k < L::kLanes; ++k) n[k] = static_cast<typename L::Scalar>(k);
  }
  static const LaneNumbers kNumbers;
};
template <class L>
inline constexpr LaneNumbers<L> LaneNumbers<L>::kNumbers{};

template <class L>
[[gnu::always_inline]] inline L LoadFloats(const float* p) {
  typedef float Floats __attribute__((vector_size(L::kLanes * sizeof(float))));
  Floats floats;
  std::memcpy(&floats, p, sizeof floats);
  return L::Of(__builtin_convertvector(floats, typename L::Vector));
}

// For the four corners of a face: modes 1, eta, zeta, eta zeta of each component.
template <class L>
struct FaceModes {
  L m[3][4];
};

// The scale of the lanes' voxels; zero beyond the end of the run.
template <class L, class S>
[[gnu::always_inline]] inline L ScaleOf(const ProductTask<S>& task, const VoxelRun& run, std::int32_t at) {
  const L scale = LoadFloats<L>(task.scale + run.first_voxel + at);
  if (at + L::kLanes <= run.length) return scale;
  return Select(L::Load(LaneNumbers<L>::kNumbers.n) < L(static_cast<double>(run.length - at)), scale, L(0.0));
}
template <class L, class S>
[[gnu::always_inline]] inline BrickModuli<L> ModuliOfLanes(const ProductTask<S>& task, const VoxelRun& run, L scale) {
  const BrickModuli<S> material = task.moduli[run.material];
  return {scale * L(material.lambda), scale * L(material.lambda_out), scale * L(material.mu)};
}

// Forces of unrotated bricks.
template <class L>
struct LinearBrick {
  using Task = ProductTask<typename L::Scalar>;
  static constexpr int kFields = 1;
  [[gnu::always_inline]] static void Forces(const Task& task, const VoxelRun& run, std::int32_t at,
                                            const L (&u)[1][3][8], L (&f)[3][8]) {
    ModeForces(*task.shape, ModuliOfLanes(task, run, ScaleOf<L>(task, run, at)), u[0], f);
  }
};

// y += forces of the bricks of some runs, with modal forces f(u) by Brick::Forces. Of kFields fields, the first is
// task.x, the second task.at.
template <class L, class Brick>
struct RunSum {
  using S = typename L::Scalar;
  using Task = typename Brick::Task;
  static constexpr int kFields = Brick::kFields;
  static constexpr int kAhead = 1024 / sizeof(S);  // nodes

  [[gnu::always_inline]] static const S* ComponentOf(const Task& task, int field, int d) {
    if constexpr (kFields == 2) {
      if (field == 1) return task.at[d];
    }
    return task.x[d];
  }

  // VoxelRun::node, widened to the size of addresses: otherwise every address computation would begin with a
  // conversion.
  struct Rows {
    explicit Rows(const VoxelRun& run) : node{run.node[0], run.node[1], run.node[2], run.node[3]} {}
    std::ptrdiff_t node[4];
  };

  [[gnu::always_inline]] static void LoadFaces(const Task& task, const Rows& rows, std::int32_t at,
                                               FaceModes<L> (&faces)[kFields]) {
    for (int k = 0; k < kFields; ++k) {
      for (int d = 0; d < 3; ++d) {
        const S* const x = ComponentOf(task, k, d) + at;
        const L p0 = L::Load(x + rows.node[0]), p1 = L::Load(x + rows.node[1]);
        const L p2 = L::Load(x + rows.node[2]), p3 = L::Load(x + rows.node[3]);
        const L near = p0 + p1, far = p2 + p3, near_y = p1 - p0, far_y = p3 - p2;
        faces[k].m[d][0] = near + far;
        faces[k].m[d][1] = near_y + far_y;
        faces[k].m[d][2] = far - near;
        faces[k].m[d][3] = far_y - near_y;
      }
    }
  }

  // y += the four corners' values of face modes f; only the first `count` lanes belong to the run. Loops over corners
  // contain whole vectors only: compilers unroll them, and everything stays in registers.
  [[gnu::always_inline]] static void AddFace(const Task& task, const Rows& rows, std::int32_t at, std::int32_t count,
                                             const FaceModes<L>& f) {
    L p[3][4];
    for (int d = 0; d < 3; ++d) {
      const L near = f.m[d][0] - f.m[d][2], far = f.m[d][0] + f.m[d][2];
      const L near_y = f.m[d][1] - f.m[d][3], far_y = f.m[d][1] + f.m[d][3];
      p[d][0] = near - near_y;
      p[d][1] = near + near_y;
      p[d][2] = far - far_y;
      p[d][3] = far + far_y;
    }
    // Values beyond the run are zeros; adding them is harmless unless another thread works there.
    if (count >= L::kLanes || rows.node[3] + at + L::kLanes <= task.end_node) [[likely]] {
      for (int d = 0; d < 3; ++d) {
        for (int r = 0; r < 4; ++r) {
          S* const y = task.y[d] + rows.node[r] + at;
          (L::Load(y) + p[d][r]).Store(y);
        }
      }
      return;
    }
    S values[3][4][L::kLanes];
    for (int d = 0; d < 3; ++d) {
      for (int r = 0; r < 4; ++r) p[d][r].Store(values[d][r]);
    }
    for (int d = 0; d < 3; ++d) {
      for (int r = 0; r < 4; ++r) {
        S* const y = task.y[d] + rows.node[r] + at;
        for (std::int32_t k = 0; k < count; ++k) y[k] += values[d][r][k];
      }
    }
  }

  // sum: face modes of the forces on the left faces of bricks at + 0, 1, ..., from these bricks and their left
  // neighbours. left: displacements of these faces. pending: forces on the right faces. Both are updated for the next
  // bricks.
  [[gnu::always_inline]] static void SumBricks(const Task& task, const VoxelRun& run, const Rows& rows, std::int32_t at,
                                               FaceModes<L> (&left)[kFields], FaceModes<L>& pending,
                                               FaceModes<L>& sum) {
    FaceModes<L> next[kFields];
    LoadFaces(task, rows, at + L::kLanes, next);
    L u[kFields][3][8], f[3][8];
    for (int k = 0; k < kFields; ++k) {
      for (int d = 0; d < 3; ++d) {
        for (int m = 0; m < 4; ++m) {
          const L right = NextLanes(left[k].m[d][m], next[k].m[d][m]);
          if (m > 0) u[k][d][2 * m] = right + left[k].m[d][m];
          u[k][d][2 * m + 1] = right - left[k].m[d][m];
        }
      }
      left[k] = next[k];
    }
    Brick::Forces(task, run, at, u, f);
    for (int d = 0; d < 3; ++d) {
      for (int m = 0; m < 4; ++m) {
        const L odd = f[d][2 * m + 1];
        const L on_right = m == 0 ? odd : f[d][2 * m] + odd;
        const L on_left = m == 0 ? -odd : f[d][2 * m] - odd;
        sum.m[d][m] = on_left + PreviousLanes(pending.m[d][m], on_right);
        pending.m[d][m] = on_right;
      }
    }
  }

  // The run is a copy, so that its members stay in registers.
  [[gnu::always_inline]] static void AddRun(const Task& task, const VoxelRun run) {
    const Rows rows(run);
    const std::int32_t nodes = run.length + 1;
    FaceModes<L> left[kFields], pending, sum;
    LoadFaces(task, rows, 0, left);
    for (int d = 0; d < 3; ++d) {
      for (int m = 0; m < 4; ++m) pending.m[d][m] = L(0.0);
    }
    std::int32_t at = 0;
    for (; at < run.length; at += L::kLanes) {
      // Prefetch: rows are too short for the hardware prefetcher. The other two rows were read one row ago.
      for (int d = 0; d < 3; ++d) {
        __builtin_prefetch(task.x[d] + rows.node[1] + at + kAhead);
        __builtin_prefetch(task.x[d] + rows.node[3] + at + kAhead);
      }
      SumBricks(task, run, rows, at, left, pending, sum);
      AddFace(task, rows, at, nodes - at, sum);
    }
    if (at == nodes - 1) {  // bricks fill the lanes: the last nodes have no brick on their right
      for (int d = 0; d < 3; ++d) {
        for (int m = 0; m < 4; ++m) sum.m[d][m] = PreviousLanes(pending.m[d][m], L(0.0));
      }
      AddFace(task, rows, at, 1, sum);
    }
  }

  [[gnu::flatten]] static void Add(const Task& task) {
    for (std::int32_t r = 0; r < task.run_count; ++r) AddRun(task, task.runs[r]);
  }
};

// Bricks with matrices of their own, 16 at a time.
template <class Set>
struct PackedProduct {
  using L = Lanes<float, Set>;

  [[gnu::flatten]] static void Add(const PackedTask& task) {
    for (std::int32_t b = 0; b < task.block_count; ++b) AddBlock(task, task.blocks[b]);
  }

  static void AddBlock(const PackedTask& task, const PackedBricks& block) {
    alignas(64) float x[24][kBrickBlock], y[24][kBrickBlock];
    for (int c = 0; c < 8; ++c) {
      for (int d = 0; d < 3; ++d) {
        for (int k = 0; k < kBrickBlock; ++k) x[3 * c + d][k] = task.x[d][block.node[c >> 1][k] + (c & 1)];
      }
    }
    for (int lane = 0; lane < kBrickBlock; lane += L::kLanes) Multiply(block, lane, x, y);
    for (int c = 0; c < 8; ++c) {
      for (int k = 0; k < block.bricks; ++k) {
        const std::int32_t node = block.node[c >> 1][k] + (c & 1);
        for (int d = 0; d < 3; ++d) task.y[d][node] += y[3 * c + d][k];
      }
    }
  }

  // Entry (r, c), c <= r, is number r (r + 1)/2 + c.
  static void Multiply(const PackedBricks& block, int lane, const float (&x)[24][kBrickBlock],
                       float (&y)[24][kBrickBlock]) {
    for (int r = 0; r < 24; ++r) {
      const float(*const row)[kBrickBlock] = &block.entries[r * (r + 1) / 2];
      const L xr = L::Load(&x[r][lane]);
      L sum = L::Load(&row[r][lane]) * xr;
      for (int c = 0; c < r; ++c) {
        const L entry = L::Load(&row[c][lane]);
        sum += entry * L::Load(&x[c][lane]);
        (L::Load(&y[c][lane]) + entry * xr).Store(&y[c][lane]);
      }
      sum.Store(&y[r][lane]);
    }
  }
};

// Trilinear interpolation along rows of nodes.
template <class Set>
struct Transfer {
  static constexpr int kPiece = 256;  // coarse nodes at a time

  [[gnu::flatten]] static void Interpolate(const TransferTask& task) {
    for (std::int32_t r = 0; r < task.run_count; ++r) {
      for (int d = 0; d < 3; ++d) InterpolateRun(task.runs[r], task.from[d], task.to[d]);
    }
  }
  [[gnu::flatten]] static void Transpose(const TransferTask& task) {
    for (std::int32_t r = 0; r < task.run_count; ++r) {
      for (int d = 0; d < 3; ++d) TransposeRun(task.runs[r], task.from[d], task.to[d]);
    }
  }

  static float WeightOf(const TransferRun& run) { return run.rows == 1 ? 1.0f : run.rows == 2 ? 0.5f : 0.25f; }

  // Fine nodes of a piece are counted from the first coarse node; where that is not a fine node of the run, odd is 1.
  static std::int32_t FineCount(const TransferRun& run, std::int32_t piece) {
    const std::int32_t left = run.odd + run.length - 2 * piece;
    return left < 2 * kPiece ? left : 2 * kPiece;
  }

  static void InterpolateRun(const TransferRun& run, const float* coarse, float* fine) {
    const float weight = WeightOf(run);
    for (std::int32_t piece = 0; 2 * piece < run.odd + run.length; piece += kPiece) {
      const std::int32_t fine_count = FineCount(run, piece);
      float row[kPiece + 1], line[2 * kPiece + 2];
      const std::int32_t coarse_count = fine_count / 2 + 1;
      for (std::int32_t n = 0; n < coarse_count; ++n) row[n] = coarse[run.coarse[0] + piece + n];
      for (std::int32_t k = 1; k < run.rows; ++k) {
        for (std::int32_t n = 0; n < coarse_count; ++n) row[n] += coarse[run.coarse[k] + piece + n];
      }
      for (std::int32_t n = 0; n < coarse_count; ++n) row[n] *= weight;
      for (std::int32_t n = 0; n + 1 < coarse_count; ++n) {
        line[2 * n] = row[n];
        line[2 * n + 1] = 0.5f * (row[n] + row[n + 1]);
      }
      line[2 * coarse_count - 2] = row[coarse_count - 1];
      float* const to = fine + run.first - run.odd + 2 * piece;
      for (std::int32_t n = piece == 0 ? run.odd : 0; n < fine_count; ++n) to[n] += line[n];
    }
  }

  static void TransposeRun(const TransferRun& run, const float* fine, float* coarse) {
    const float weight = WeightOf(run), half = 0.5f * weight;
    for (std::int32_t piece = 0; 2 * piece < run.odd + run.length; piece += kPiece) {
      const std::int32_t fine_count = FineCount(run, piece);
      const std::int32_t coarse_count = fine_count / 2 + 1;
      const float* const from = fine + run.first - run.odd + 2 * piece;
      float row[kPiece + 1], line[2 * kPiece + 4];  // line[n + 1]: node n
      for (std::int32_t n = piece == 0 ? run.odd : 0; n < fine_count; ++n) line[n + 1] = from[n];
      line[0] = line[fine_count + 1] = line[fine_count + 2] = 0;
      if (piece == 0 && run.odd == 1) line[1] = 0;
      for (std::int32_t n = 0; n < coarse_count; ++n) {
        row[n] = weight * line[2 * n + 1] + half * (line[2 * n] + line[2 * n + 2]);
      }
      for (std::int32_t k = 0; k < run.rows; ++k) {
        float* const to = coarse + run.coarse[k] + piece;
        for (std::int32_t n = 0; n < coarse_count; ++n) to[n] += row[n];
      }
    }
  }
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_VOXEL_KERNELS_IMPL_H_
