#include "core/tet/saddle_solvers.h"

#include <cmath>

#include "core/base/check.h"

namespace fascicle {
namespace {

constexpr std::int32_t kNone = -1;
constexpr double kSchurScale = 4;
constexpr int kMaxIterations = 100;
// Where inertia keeps the eigenvalues above this fraction of the largest (about 3), coarse levels cost more than they
// save.
constexpr double kLeastForCg = 1e-3;
constexpr int kMaxSaddleIterations = 1000;

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

DirectSaddleSolver::DirectSaddleSolver(const SaddleMatrix& matrix) : unknown_of_node_(matrix.nodes()) {
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
    : multigrid_(matrix.pattern, model.rest_positions(), matrix.free, FromCorners(model, matrix.free)) {}

IterativeSaddleSolver::Result IterativeSaddleSolver::Solve(const SaddleMatrix& matrix, const NodalVector& force,
                                                           std::span<const double> volume, double tolerance,
                                                           ThreadTeam& team, NodalVector& dx, std::span<double> dp) {
  dx.assign(force.size(), Vec3::Zero());
  std::fill(dp.begin(), dp.end(), 0.0);
  if (matrix.patches() == 0 && matrix.least_eigenvalue >= kLeastForCg) {
    return SolveByCg(matrix, force, tolerance, team, dx);
  }
  if (!multigrid_.SetUp(matrix.A, team, matrix.least_eigenvalue)) return {};
  SetScales(matrix);
  x_.resize(matrix.nodes());
  p_.resize(matrix.patches());
  volume_.resize(matrix.patches());
  Join(force, volume, true, team, joint_side_);
  const auto apply = [&](const Eigen::VectorXd& v, Eigen::VectorXd& product) {
    Split(v, true, team);
    matrix.Multiply(x_, p_, team, product_, volume_);
    Join(product_, volume_, true, team, product);
  };
  const auto precondition = [&](const Eigen::VectorXd& r, Eigen::VectorXd& z) {
    Split(r, false, team);
    for (std::size_t n = 0; n < p_.size(); ++n) p_[n] /= -schur_[n];
    matrix.AddPressureForce(p_, -1, team, x_);
    multigrid_.Apply(x_, team, product_);
    Join(product_, p_, false, team, z);
  };
  const GmresResult result =
      FlexibleGmres(team, apply, precondition, joint_side_, tolerance, kMaxIterations, joint_solution_, gmres_);
  Split(joint_solution_, true, team);
  dx = x_;
  std::copy(p_.begin(), p_.end(), dp.begin());
  return {result.converged, result.least_eigenvalue >= 0, result.iterations};
}

IterativeSaddleSolver::Result IterativeSaddleSolver::SolveByCg(const SaddleMatrix& matrix, const NodalVector& force,
                                                               double tolerance, ThreadTeam& team, NodalVector& dx) {
  const MixedPrecisionCg::Result result =
      cg_.Solve(matrix.pattern, matrix.A, force, tolerance, kMaxSaddleIterations, team, dx);
  return {result.converged, result.is_positive, result.iterations};
}

void IterativeSaddleSolver::SetScales(const SaddleMatrix& matrix) {
  const std::size_t nodes = matrix.nodes();
  scale_.resize(static_cast<Eigen::Index>(3 * nodes + matrix.patches()));
  for (std::size_t n = 0; n < nodes; ++n) {
    const auto i = static_cast<std::int32_t>(n);
    const Mat3& diagonal = matrix.A[matrix.pattern.PlaceOf(i, i)];
    const double least = 1e-6 * diagonal.norm();
    for (int c = 0; c < 3; ++c) scale_[3 * n + c] = 1 / std::sqrt(std::max(std::abs(diagonal(c, c)), least));
  }
  schur_.resize(matrix.patches());
  for (std::size_t p = 0; p < schur_.size(); ++p) {
    double sum = 0;
    for (std::int32_t k = matrix.volume_pattern.begin[p]; k < matrix.volume_pattern.begin[p + 1]; ++k) {
      const std::size_t n = matrix.volume_pattern.column[k];
      for (int c = 0; c < 3; ++c) sum += std::pow(matrix.B[k][c] * scale_[3 * n + c], 2);
    }
    schur_[p] = matrix.C[p] + kSchurScale * sum;
    scale_[3 * nodes + p] = 1 / std::sqrt(schur_[p]);
  }
}

// Splits a joint vector into x_ and p_, multiplied or divided by its scales.
void IterativeSaddleSolver::Split(const Eigen::VectorXd& joint, bool times_scale, ThreadTeam& team) {
  const auto part = [&](std::size_t i) { return times_scale ? joint[i] * scale_[i] : joint[i] / scale_[i]; };
  ForNodes(team, x_.size(), [&](std::size_t n) {
    for (int c = 0; c < 3; ++c) x_[n][c] = part(3 * n + c);
  });
  for (std::size_t n = 0; n < p_.size(); ++n) p_[n] = part(3 * x_.size() + n);
}

void IterativeSaddleSolver::Join(const NodalVector& x, std::span<const double> p, bool times_scale, ThreadTeam& team,
                                 Eigen::VectorXd& joint) const {
  joint.resize(scale_.size());
  const auto part = [&](std::size_t i, double v) { return times_scale ? v * scale_[i] : v / scale_[i]; };
  ForNodes(team, x.size(), [&](std::size_t n) {
    for (int c = 0; c < 3; ++c) joint[3 * n + c] = part(3 * n + c, x[n][c]);
  });
  for (std::size_t n = 0; n < p.size(); ++n) joint[3 * x.size() + n] = part(3 * x.size() + n, p[n]);
}

}  // namespace fascicle
