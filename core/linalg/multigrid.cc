#include "core/linalg/multigrid.h"

#include <cmath>

#include "core/base/check.h"

namespace fascicle {
namespace {

// A level with at most this many blocks is factored.
constexpr std::size_t kCoarsest = 500;
constexpr std::size_t kMostLevels = 10;
constexpr int kPowerIterations = 12;
constexpr double kEigenvalueMargin = 1.15;
// Added to the coarsest diagonal, relative to it, for rotations that have no stiffness.
constexpr double kCoarseRegularization = 1e-9;

// A pseudorandom vector, the same every time.
FloatField StartVector(std::size_t size) {
  FloatField start(size);
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

// An upper estimate for the matrix preconditioned by its diagonal blocks, by power iteration.
double LargestPreconditioned(const SweepMatrix& matrix, ThreadTeam& team) {
  FloatField v = StartVector(matrix.rows()), w(matrix.rows());
  const auto length_of = [&](const FloatField& field) {
    return std::sqrt(
        SumOverNodes(team, field.size(), [&](std::size_t n) { return static_cast<double>(field[n].squaredNorm()); }));
  };
  double length = length_of(v);
  for (int i = 0; i < kPowerIterations; ++i) {
    const auto scale = static_cast<float>(1 / length);
    matrix.Multiply(v, team, w);
    ForNodes(team, v.size(), [&](std::size_t n) { v[n] = matrix.inverse_diagonal(n) * (scale * w[n]); });
    length = length_of(v);
  }
  return length * kEigenvalueMargin;
}

NodalVector PositionsOf(const std::vector<RigidBlock>& blocks) {
  NodalVector positions;
  for (const RigidBlock& block : blocks) positions.push_back(block.position);
  return positions;
}

}  // namespace

struct Multigrid::Level {
  Level(const BlockPattern& p, std::vector<RigidBlock> meaning)
      : pattern(&p), free(p.rows(), {true, true, true}), blocks(std::move(meaning)), matrix(p, PositionsOf(blocks)) {}

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
  SweepMatrix matrix;
  FloatField r, coarse_b, coarse_x;  // scratch
  // Interpolation from the next coarser level, where there is one. `rows` and `columns` have its float values in the
  // order of both levels' matrices.
  std::optional<Prolongation> prolongation;
  GalerkinProduct galerkin;
  BlockPattern rows;
  TransposedPattern columns;
  std::vector<FloatBlock> interpolation;
  BlockValues coarse_values;
};

Multigrid::Multigrid(const BlockPattern& pattern, const NodalVector& positions, const FreeComponents& free,
                     std::optional<Prolongation> first) {
  std::vector<RigidBlock> blocks;
  for (const Vec3& X : positions) blocks.push_back({X, 0});
  levels_.push_back(std::make_unique<Level>(pattern, std::move(blocks)));
  Level& finest = *levels_.front();
  finest.free = free;
  finest.prolongation = std::move(first);
  first_is_given_ = finest.prolongation.has_value();
}

Multigrid::~Multigrid() = default;

bool Multigrid::SetUp(const BlockValues& values, ThreadTeam& team) {
  const BlockValues* current = &values;
  for (std::size_t l = 0; HasCoarser(l); ++l) {
    Level& level = *levels_[l];
    level.matrix.SetValues(*current, team);
    if (l + 1 == levels_.size()) AddLevel(*current, team);
    level.galerkin.Compute(*level.pattern, *current, *level.prolongation, team, level.coarse_values);
    levels_[l + 1]->IsolateUnused(level.coarse_values);
    current = &level.coarse_values;
  }
  if (levels_.size() == 1) levels_.front()->matrix.SetValues(values, team);
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
void Multigrid::AddLevel(const BlockValues& values, ThreadTeam& team) {
  Level& level = *levels_.back();
  std::vector<RigidBlock> coarse_blocks;
  if (!level.prolongation) {
    BlockValues inverse_diagonal(level.pattern->rows());
    for (std::size_t i = 0; i < inverse_diagonal.size(); ++i) {
      const auto n = static_cast<std::int32_t>(i);
      inverse_diagonal[i] = PositiveInverse(values[level.pattern->PlaceOf(n, n)]);
    }
    level.prolongation = SmoothedAggregation(*level.pattern, values, level.free, level.blocks, inverse_diagonal,
                                             LargestPreconditioned(level.matrix, team), coarse_blocks);
  } else {
    // A block of the coarser level has the position of the finer block that depends on it alone.
    coarse_blocks.resize(level.prolongation->coarse);
    const BlockPattern& rows = level.prolongation->pattern;
    for (std::size_t i = 0; i < rows.rows(); ++i) {
      if (rows.begin[i + 1] - rows.begin[i] == 1) coarse_blocks[rows.column[rows.begin[i]]] = level.blocks[i];
    }
  }
  level.galerkin = GalerkinProduct(*level.pattern, *level.prolongation);
  levels_.push_back(std::make_unique<Level>(level.galerkin.pattern(), std::move(coarse_blocks)));
  const SweepOrder& fine = level.matrix.order();
  const SweepOrder& coarse = levels_.back()->matrix.order();
  level.rows = {};
  level.interpolation.clear();
  for (const std::int32_t i : fine.row) {
    const BlockPattern& pattern = level.prolongation->pattern;
    for (std::int32_t k = pattern.begin[i]; k < pattern.begin[i + 1]; ++k) {
      level.rows.column.push_back(coarse.place[pattern.column[k]]);
      level.interpolation.emplace_back(level.prolongation->values[k]);
    }
    level.rows.begin.push_back(static_cast<std::int32_t>(level.rows.column.size()));
  }
  level.columns = TransposedPattern(level.rows, coarse.row.size());
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

const SweepMatrix& Multigrid::finest() const { return levels_.front()->matrix; }

void Multigrid::Apply(const FloatField& r, ThreadTeam& team, FloatField& z) {
  z.resize(r.size());
  Cycle(0, r, team, z);
}

void Multigrid::Cycle(std::size_t l, const FloatField& b, ThreadTeam& team, FloatField& x) {
  Level& level = *levels_[l];
  if (l + 1 == levels_.size()) {
    SolveCoarsest(b, x);
    return;
  }
  level.r.resize(b.size());
  level.coarse_b.resize(level.prolongation->coarse);
  level.coarse_x.resize(level.prolongation->coarse);
  level.matrix.SweepFromZero(b, team, x);
  level.matrix.ResidualAfterSweep(x, team, level.r);
  const BlockPattern& restriction = level.columns.pattern;
  ForNodes(team, level.coarse_b.size(), [&](std::size_t n) {
    Vec4f sum = Vec4f::Zero();
    for (std::int32_t k = restriction.begin[n]; k < restriction.begin[n + 1]; ++k) {
      sum += level.interpolation[level.columns.source[k]].TransposedTimes(level.r[restriction.column[k]]);
    }
    level.coarse_b[n] = sum;
  });
  Cycle(l + 1, level.coarse_b, team, level.coarse_x);
  ForNodes(team, x.size(), [&](std::size_t n) {
    for (std::int32_t k = level.rows.begin[n]; k < level.rows.begin[n + 1]; ++k) {
      x[n] += level.interpolation[k] * level.coarse_x[level.rows.column[k]];
    }
  });
  level.matrix.SweepBack(b, team, x);
}

void Multigrid::SolveCoarsest(const FloatField& b, FloatField& x) {
  const std::vector<std::int32_t>& row = levels_.back()->matrix.order().row;
  for (std::size_t i = 0; i < b.size(); ++i) {
    for (int c = 0; c < 3; ++c) coarsest_side_[3 * row[i] + c] = b[i][c];
  }
  coarsest_.Solve(coarsest_side_);
  for (std::size_t i = 0; i < b.size(); ++i) {
    for (int c = 0; c < 3; ++c) x[i][c] = static_cast<float>(coarsest_side_[3 * row[i] + c]);
    x[i][3] = 0;
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
