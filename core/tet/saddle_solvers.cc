#include "core/tet/saddle_solvers.h"

#include <cmath>

#include "core/base/check.h"

namespace fascicle {
namespace {

constexpr std::int32_t kNone = -1;
constexpr int kMaxIterations = 100;
// Where inertia keeps the eigenvalues above this fraction of the largest (about 3), coarse levels cost more than they
// save.
constexpr double kLeastForCg = 1e-3;
constexpr int kMaxSaddleIterations = 1000;
// Reduction of the residual for which one solve in single precision aims.
constexpr double kGain = 1e-4;
// How far the residual in double precision may exceed the tolerance. A refinement that reduces it by less than
// kLeastGain has failed.
constexpr double kSlack = 1.1, kLeastGain = 0.5;
// The least reduction that is worth a refinement.
constexpr double kLeastPass = 0.1;

// Interpolation from the corners of elements to all of their nodes, along straight edges and within flat sides; nothing
// for elements that have corners only.
std::optional<Prolongation> FromCorners(const TetModel& model, const FreeComponents& free) {
  constexpr std::array<std::int32_t, 8> kNoParents = {kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone};
  std::vector<std::array<std::int32_t, 8>> parents(model.nodes(), kNoParents);
  for (const TetBody& body : model.bodies()) {
    model.ForHigherNodes(body, [&](std::int32_t node, std::span<const std::int32_t> corners) {
      std::copy(corners.begin(), corners.end(), parents[node].begin());
    });
  }
  std::vector<std::int32_t> coarse_of(model.nodes(), kNone);
  Prolongation result;
  result.is_diagonal = true;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    if (parents[n][0] == kNone) coarse_of[n] = static_cast<std::int32_t>(result.coarse++);
  }
  if (result.coarse == model.nodes()) return std::nullopt;
  PatternBuilder builder;
  std::vector<std::int32_t> columns;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    columns.clear();
    if (coarse_of[n] != kNone) columns.push_back(coarse_of[n]);
    for (const std::int32_t parent : parents[n]) {
      if (parent != kNone) columns.push_back(coarse_of[parent]);
    }
    builder.AddRow(columns);
  }
  result.pattern = builder.Take();
  result.values.resize(result.pattern.blocks());
  std::vector<std::int32_t> corner_of(result.coarse);
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    if (coarse_of[n] != kNone) corner_of[coarse_of[n]] = static_cast<std::int32_t>(n);
  }
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    const double weight = 1.0 / (result.pattern.begin[n + 1] - result.pattern.begin[n]);
    for (std::int32_t k = result.pattern.begin[n]; k < result.pattern.begin[n + 1]; ++k) {
      result.values[k].setZero();
      for (int c = 0; c < 3; ++c) {
        if (free[n][c] && free[corner_of[result.pattern.column[k]]][c]) result.values[k](c, c) = weight;
      }
    }
  }
  return result;
}

}  // namespace

DirectSaddleSolver::DirectSaddleSolver(const SaddleMatrix& matrix, const std::stop_token& stop)
    : unknown_of_node_(matrix.nodes()), solver_(stop) {
  for (std::size_t n = 0; n < matrix.nodes(); ++n) {
    for (int c = 0; c < 3; ++c) unknown_of_node_[n][c] = matrix.free[n][c] ? node_unknowns_++ : kNone;
  }
  const auto unknowns = static_cast<std::int32_t>(node_unknowns_ + matrix.patches());
  std::vector<std::int32_t> rows, columns;
  ForEntries(matrix, [&](std::int32_t row, std::int32_t column, double) {
    rows.push_back(row);
    columns.push_back(column);
  });
  values_.resize(rows.size());
  side_.resize(unknowns);
  FASCICLE_CHECK(unknowns == 0 || solver_.Analyze(unknowns, rows, columns), "not enough memory for the analysis");
}

// Visits the lower triangle of the unknown components.
template <class Visit>
void DirectSaddleSolver::ForEntries(const SaddleMatrix& matrix, const Visit& visit) const {
  for (std::size_t n = 0; n < matrix.nodes(); ++n) {
    for (std::int32_t k = matrix.pattern.begin[n]; k < matrix.pattern.begin[n + 1]; ++k) {
      const std::size_t m = matrix.pattern.column[k];
      if (m > n) break;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < (m == n ? i + 1 : 3); ++j) {
          const std::int32_t row = unknown_of_node_[n][i], column = unknown_of_node_[m][j];
          if (row != kNone && column != kNone) visit(row, column, matrix.A[k](i, j));
        }
      }
    }
  }
  for (std::size_t p = 0; p < matrix.patches(); ++p) {
    const auto row = static_cast<std::int32_t>(node_unknowns_ + p);
    for (std::int32_t k = matrix.volume_pattern.begin[p]; k < matrix.volume_pattern.begin[p + 1]; ++k) {
      for (int j = 0; j < 3; ++j) {
        const std::int32_t column = unknown_of_node_[matrix.volume_pattern.column[k]][j];
        if (column != kNone) visit(row, column, matrix.B[k][j]);
      }
    }
    visit(row, row, -matrix.C[p]);
  }
}

bool DirectSaddleSolver::Factor(const SaddleMatrix& matrix) {
  std::size_t at = 0;
  ForEntries(matrix, [&](std::int32_t, std::int32_t, double value) { values_[at++] = value; });
  const DirectSolver::Factored factored = solver_.Factor(values_);
  return factored.ok && factored.negative_pivots == static_cast<std::int32_t>(matrix.patches());
}

void DirectSaddleSolver::Solve(const NodalVector& force, std::span<const double> volume, NodalVector& dx,
                               std::span<double> dp) {
  for (std::size_t n = 0; n < force.size(); ++n) {
    for (int c = 0; c < 3; ++c) {
      if (unknown_of_node_[n][c] != kNone) side_[unknown_of_node_[n][c]] = force[n][c];
    }
  }
  std::copy(volume.begin(), volume.end(), side_.begin() + node_unknowns_);
  solver_.Solve(side_);
  dx.assign(force.size(), Vec3::Zero());
  for (std::size_t n = 0; n < force.size(); ++n) {
    for (int c = 0; c < 3; ++c) {
      if (unknown_of_node_[n][c] != kNone) dx[n][c] = side_[unknown_of_node_[n][c]];
    }
  }
  std::copy(side_.begin() + node_unknowns_, side_.end(), dp.begin());
}

IterativeSaddleSolver::IterativeSaddleSolver(const TetModel& model, const SaddleMatrix& matrix)
    : multigrid_(matrix.pattern, model.rest_positions(), matrix.free, FromCorners(model, matrix.free)),
      saddle_(matrix, multigrid_.finest().order()) {}

bool IterativeSaddleSolver::SuitsCg(const SaddleMatrix& matrix) {
  return matrix.patches() == 0 && matrix.least_eigenvalue >= kLeastForCg;
}

void IterativeSaddleSolver::SetUp(const SaddleMatrix& matrix, ThreadTeam& team) {
  if (SuitsCg(matrix)) {
    cg_.SetUp(matrix.pattern, matrix.A, team);
    return;
  }
  // Coarse levels pay even where inertia bounds the spectrum: smoothing alone takes eight times as many iterations.
  is_set_up_ = multigrid_.SetUp(matrix.A, team);
  saddle_.SetValues(matrix, team);
}

IterativeSaddleSolver::Result IterativeSaddleSolver::Solve(const SaddleMatrix& matrix, const NodalVector& force,
                                                           std::span<const double> volume, double tolerance,
                                                           ThreadTeam& team, NodalVector& dx, std::span<double> dp) {
  dx.assign(force.size(), Vec3::Zero());
  std::fill(dp.begin(), dp.end(), 0.0);
  if (SuitsCg(matrix)) return SolveByCg(matrix, force, tolerance, team, dx);
  if (!is_set_up_) return {};
  Result result;
  result.is_minimum = true;
  const double start = saddle_.NormOf(force, volume, team);
  if (!std::isfinite(start)) return {};
  residual_ = force;
  volume_residual_.assign(volume.begin(), volume.end());
  for (double norm = start; norm > kSlack * tolerance * start;) {
    saddle_.FromDouble(residual_, volume_residual_, 1 / norm, team, side_);
    const double goal = std::clamp(tolerance * start / norm, kGain, kLeastPass);
    const GmresResult pass = Iterate(goal, kMaxIterations - result.iterations, team);
    result.iterations += pass.iterations;
    result.is_minimum &= pass.least_eigenvalue >= 0;
    if (!pass.converged || !result.is_minimum) return result;
    saddle_.AddTo(dx, dp, norm, team, solution_);
    matrix.Multiply(dx, dp, team, residual_, volume_residual_);
    ForNodes(team, dx.size(), [&](std::size_t n) { residual_[n] = force[n] - residual_[n]; });
    for (std::size_t n = 0; n < dp.size(); ++n) volume_residual_[n] = volume[n] - volume_residual_[n];
    const double left = saddle_.NormOf(residual_, volume_residual_, team);
    if (!(left < kLeastGain * norm)) return result;
    norm = left;
  }
  result.ok = true;
  return result;
}

// Solves for side_ in single precision.
GmresResult IterativeSaddleSolver::Iterate(double tolerance, int max_iterations, ThreadTeam& team) {
  const SaddleSpace space{team, side_.x.size(), side_.p.size()};
  const auto apply = [&](const SaddleField& z, SaddleField& product) {
    saddle_.Multiply(multigrid_.finest(), z, team, product);
  };
  const auto precondition = [&](const SaddleField& r, SaddleField& z) {
    saddle_.EliminatePressure(r, team, z.p, force_);
    multigrid_.Apply(force_, team, z.x);
  };
  return FlexibleGmres(space, apply, precondition, side_, tolerance, max_iterations, solution_, gmres_);
}

IterativeSaddleSolver::Result IterativeSaddleSolver::SolveByCg(const SaddleMatrix& matrix, const NodalVector& force,
                                                               double tolerance, ThreadTeam& team, NodalVector& dx) {
  const MixedPrecisionCg::Result result =
      cg_.Solve(matrix.pattern, matrix.A, force, tolerance, kMaxSaddleIterations, team, dx);
  return {result.converged, result.is_positive, result.iterations};
}

}  // namespace fascicle
