#include "core/linalg/multigrid.h"

#include <cmath>

#include "core/base/check.h"

namespace fascicle {
namespace {

using Field = FloatField;

// A level with at most this many blocks is factored.
constexpr std::size_t kCoarsest = 500;
constexpr std::size_t kMostLevels = 10;
constexpr int kSmoothing = 3;  // degree of the smoothing polynomials
// The polynomials damp the part of the spectrum between this multiple of the largest eigenvalue and the eigenvalue
// itself.
constexpr float kDamped = 1.0f / 8;
// Spectra with a ratio of the largest to the least eigenvalue below this need no coarser levels.
constexpr double kMostSpread = 3000;
constexpr int kPowerIterations = 12;
constexpr float kEigenvalueMargin = 1.15f;
// Added to the coarsest diagonal, relative to it, for rotations that have no stiffness.
constexpr double kCoarseRegularization = 1e-9;

// A pseudorandom vector, the same every time.
Field StartVector(std::size_t size) {
  Field start(size);
  std::uint32_t state = 1;
  for (Vec4f& v : start) {
    for (int c = 0; c < 3; ++c) {
      state = 1664525u * state + 1013904223u;
      v[c] = static_cast<float>(state >> 8) * 0x1p-24f - 0.5f;
    }
    v[3] = 0;
  }
  return start;
}

float SquaredNorm(const Field& v, ThreadTeam& team) {
  return static_cast<float>(
      SumOverNodes(team, v.size(), [&](std::size_t n) { return static_cast<double>(v[n].squaredNorm()); }));
}

}  // namespace

struct Multigrid::Level {
  explicit Level(const BlockPattern& p) : pattern(&p), free(p.rows(), {true, true, true}) {
    for (Field* field : {&x, &b, &r, &d, &d_next}) field->assign(p.rows(), Vec4f::Zero());
  }

  // By power iteration.
  void FindLargestEigenvalue(ThreadTeam& team) {
    Field v = StartVector(pattern->rows()), w(pattern->rows());
    double length = std::sqrt(SquaredNorm(v, team));
    for (int i = 0; i < kPowerIterations; ++i) {
      const auto scale = static_cast<float>(1 / length);
      ForNodes(team, v.size(),
               [&](std::size_t n) { w[n] = matrix.inverse_diagonal(n) * (matrix.RowTimes(n, v) * scale); });
      std::swap(v, w);
      length = std::sqrt(SquaredNorm(v, team));
    }
    largest_eigenvalue = static_cast<float>(length) * kEigenvalueMargin;
  }

  // x += q(D^-1 A) D^-1 (b - A x) with a polynomial q; from_zero: x counts as zero, whatever it holds.
  void Smooth(bool from_zero, ThreadTeam& team) {
    const std::size_t size = pattern->rows();
    const float centre = 0.5f * (1 + damped) * largest_eigenvalue, half = 0.5f * (1 - damped) * largest_eigenvalue;
    const float sigma = centre / half;
    float rho = 1 / sigma;
    ForNodes(team, size, [&](std::size_t n) {
      r[n] = from_zero ? b[n] : Vec4f(b[n] - matrix.RowTimes(n, x));
      d[n] = (matrix.inverse_diagonal(n) * r[n]) / centre;
    });
    for (int k = 0; k < kSmoothing; ++k) {
      if (k + 1 == kSmoothing) {
        ForNodes(team, size, [&](std::size_t n) { x[n] = from_zero && k == 0 ? d[n] : Vec4f(x[n] + d[n]); });
        return;
      }
      const float rho_next = 1 / (2 * sigma - rho);
      const float keep = rho_next * rho, step = 2 * rho_next / half;
      ForNodes(team, size, [&](std::size_t n) {
        x[n] = from_zero && k == 0 ? d[n] : Vec4f(x[n] + d[n]);
        r[n] -= matrix.RowTimes(n, d);
        d_next[n] = keep * d[n] + step * (matrix.inverse_diagonal(n) * r[n]);
      });
      std::swap(d, d_next);
      rho = rho_next;
    }
  }

  // Isolates components that no free component of the finer level depends on.
  void IsolateUnused(BlockValues& values) {
    for (std::size_t i = 0; i < pattern->rows(); ++i) {
      const auto n = static_cast<std::int32_t>(i);
      Mat3& diagonal = values[pattern->PlaceOf(n, n)];
      for (int c = 0; c < 3; ++c) {
        free[i][c] = diagonal(c, c) != 0;
        if (!free[i][c]) diagonal(c, c) = 1;
      }
    }
  }

  const BlockPattern* pattern;  // owned by the caller or the finer level
  FreeComponents free;
  std::vector<RigidBlock> blocks;
  FloatMatrix matrix;
  float largest_eigenvalue = 1;
  float damped = kDamped;  // part of the spectrum that is damped, see kDamped
  Field x, b, r, d, d_next;
  // Interpolation from the next coarser level, where there is one.
  std::optional<Prolongation> prolongation;
  GalerkinProduct galerkin;
  std::vector<FloatBlock> interpolation;
  BlockValues coarse_values;
};

Multigrid::Multigrid(const BlockPattern& pattern, const NodalVector& positions, const FreeComponents& free,
                     std::optional<Prolongation> first) {
  levels_.push_back(std::make_unique<Level>(pattern));
  Level& finest = *levels_.front();
  finest.free = free;
  for (const Vec3& X : positions) finest.blocks.push_back({X, 0});
  finest.prolongation = std::move(first);
  first_is_given_ = finest.prolongation.has_value();
}

Multigrid::~Multigrid() = default;

bool Multigrid::SetUp(const BlockValues& values, ThreadTeam& team, double least_eigenvalue) {
  const BlockValues* current = &values;
  for (std::size_t l = 0; HasCoarser(l); ++l) {
    Level& level = *levels_[l];
    level.matrix.SetValues(*level.pattern, *current, team);
    level.FindLargestEigenvalue(team);
    if (l == 0) {
      smoothes_only_ = least_eigenvalue * kMostSpread >= level.largest_eigenvalue;
      level.damped = smoothes_only_ ? static_cast<float>(least_eigenvalue) / level.largest_eigenvalue : kDamped;
      if (smoothes_only_) return true;
    }
    if (l + 1 == levels_.size()) AddLevel(*current);
    level.galerkin.Compute(*level.pattern, *current, *level.prolongation, team, level.coarse_values);
    levels_[l + 1]->IsolateUnused(level.coarse_values);
    current = &level.coarse_values;
  }
  return FactorCoarsest(*current);
}

void Multigrid::ForgetAggregation() {
  const std::size_t kept = first_is_given_ ? 2 : 1;
  if (levels_.size() < kept) return;
  levels_.resize(kept);
  if (levels_.back()->prolongation) levels_.back()->prolongation.reset();
  coarsest_analyzed_ = false;
}

bool Multigrid::HasCoarser(std::size_t l) const {
  return levels_[l]->prolongation || (levels_[l]->pattern->rows() > kCoarsest && l + 1 < kMostLevels);
}

// Adds a level below the last one, whose values are given.
void Multigrid::AddLevel(const BlockValues& values) {
  Level& level = *levels_.back();
  std::vector<RigidBlock> coarse_blocks;
  if (!level.prolongation) {
    BlockValues inverse_diagonal(level.pattern->rows());
    for (std::size_t i = 0; i < inverse_diagonal.size(); ++i) {
      const auto n = static_cast<std::int32_t>(i);
      inverse_diagonal[i] = PositiveInverse(values[level.pattern->PlaceOf(n, n)]);
    }
    level.prolongation = SmoothedAggregation(*level.pattern, values, level.free, level.blocks, inverse_diagonal,
                                             level.largest_eigenvalue, coarse_blocks);
  } else {
    // A block of the coarser level has the position of the finer block that depends on it alone.
    coarse_blocks.resize(level.prolongation->coarse);
    const BlockPattern& rows = level.prolongation->pattern;
    for (std::size_t i = 0; i < rows.rows(); ++i) {
      if (rows.begin[i + 1] - rows.begin[i] == 1) coarse_blocks[rows.column[rows.begin[i]]] = level.blocks[i];
    }
  }
  level.interpolation.clear();
  for (const Mat3& block : level.prolongation->values) level.interpolation.emplace_back(block);
  level.galerkin = GalerkinProduct(*level.pattern, *level.prolongation);
  levels_.push_back(std::make_unique<Level>(level.galerkin.pattern()));
  levels_.back()->blocks = std::move(coarse_blocks);
}

bool Multigrid::FactorCoarsest(const BlockValues& values) {
  const BlockPattern& pattern = *levels_.back()->pattern;
  std::vector<std::int32_t> rows, columns;
  coarsest_values_.clear();
  for (std::size_t i = 0; i < pattern.rows(); ++i) {
    for (std::int32_t k = pattern.begin[i]; k < pattern.begin[i + 1]; ++k) {
      const std::size_t j = pattern.column[k];
      if (j > i) continue;
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < (i == j ? a + 1 : 3); ++b) {
          if (!coarsest_analyzed_) {
            rows.push_back(static_cast<std::int32_t>(3 * i + a));
            columns.push_back(static_cast<std::int32_t>(3 * j + b));
          }
          const bool diagonal = i == j && a == b;
          coarsest_values_.push_back(values[k](a, b) * (diagonal ? 1 + kCoarseRegularization : 1));
        }
      }
    }
  }
  if (!coarsest_analyzed_) {
    coarsest_analyzed_ = coarsest_.Analyze(static_cast<std::int32_t>(3 * pattern.rows()), rows, columns);
    if (!coarsest_analyzed_) return false;
    coarsest_side_.resize(3 * pattern.rows());
  }
  const DirectSolver::Factored factored = coarsest_.Factor(coarsest_values_);
  return factored.ok;
}

void Multigrid::Apply(const NodalVector& r, ThreadTeam& team, NodalVector& z) {
  Level& finest = *levels_.front();
  ForNodes(team, r.size(), [&](std::size_t n) { finest.b[n] << r[n].cast<float>(), 0; });
  Cycle(0, team);
  z.resize(r.size());
  ForNodes(team, r.size(), [&](std::size_t n) { z[n] = finest.x[n].head<3>().cast<double>(); });
}

void Multigrid::Cycle(std::size_t l, ThreadTeam& team) {
  if (smoothes_only_) {
    levels_[l]->Smooth(true, team);
    return;
  }
  if (l + 1 == levels_.size()) {
    SolveCoarsest();
    return;
  }
  Level& level = *levels_[l];
  Level& coarse = *levels_[l + 1];
  level.Smooth(true, team);
  ForNodes(team, level.b.size(), [&](std::size_t n) { level.r[n] = level.b[n] - level.matrix.RowTimes(n, level.x); });
  const TransposedPattern& restriction = level.galerkin.restriction();
  ForNodes(team, coarse.b.size(), [&](std::size_t n) {
    Vec4f sum = Vec4f::Zero();
    for (std::int32_t k = restriction.pattern.begin[n]; k < restriction.pattern.begin[n + 1]; ++k) {
      sum += level.interpolation[restriction.source[k]].TransposedTimes(level.r[restriction.pattern.column[k]]);
    }
    coarse.b[n] = sum;
  });
  Cycle(l + 1, team);
  const BlockPattern& rows = level.prolongation->pattern;
  ForNodes(team, level.x.size(), [&](std::size_t n) {
    for (std::int32_t k = rows.begin[n]; k < rows.begin[n + 1]; ++k) {
      level.x[n] += level.interpolation[k] * coarse.x[rows.column[k]];
    }
  });
  level.Smooth(false, team);
}

void Multigrid::SolveCoarsest() {
  Level& level = *levels_.back();
  for (std::size_t n = 0; n < level.b.size(); ++n) {
    for (int c = 0; c < 3; ++c) coarsest_side_[3 * n + c] = level.b[n][c];
  }
  coarsest_.Solve(coarsest_side_);
  for (std::size_t n = 0; n < level.b.size(); ++n) {
    for (int c = 0; c < 3; ++c) level.x[n][c] = static_cast<float>(coarsest_side_[3 * n + c]);
  }
}

std::string Multigrid::Description() const {
  std::string text;
  for (const auto& level : levels_) {
    if (!text.empty()) text += " + ";
    text += std::to_string(level->pattern->rows());
  }
  return text + " blocks";
}

}  // namespace fascicle
