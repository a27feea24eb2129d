#include "core/skeleton/force_distribution.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/linalg/active_set_qp.h"

namespace fascicle {
namespace {

using Eigen::Index;
using Triplets = std::vector<Eigen::Triplet<double>>;

// Weight of the effort beside a lack of the whole capacity, where the demand cannot be met.
constexpr double kEffortBesideLack = 1e-9;

// Rows of A that are not zero, each divided by its largest component, of unknowns (a, e): A a / s + e = b / s, without
// e unless `with_lack`.
ConstraintRows ScaledRows(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& scale,
                          bool with_lack) {
  Triplets entries;
  std::vector<double> right;
  for (Index j = 0; j < A.rows(); ++j) {
    if (scale[j] == 0) continue;
    const auto row = static_cast<Index>(right.size());
    for (Index m = 0; m < A.cols(); ++m) {
      if (A(j, m) != 0) entries.emplace_back(row, m, A(j, m) / scale[j]);
    }
    if (with_lack) entries.emplace_back(row, A.cols() + row, 1);
    right.push_back(b[j] / scale[j]);
  }
  const auto rows = static_cast<Index>(right.size());
  ConstraintRows result{RowMatrix(rows, A.cols() + (with_lack ? rows : 0)),
                        Eigen::Map<const Eigen::VectorXd>(right.data(), rows)};
  result.G.setFromTriplets(entries.begin(), entries.end());
  return result;
}

// a >= 0, and -a >= -1, of `muscles` unknowns among `unknowns`.
ConstraintRows Bounds(Index muscles, Index unknowns) {
  Triplets entries;
  ConstraintRows rows{RowMatrix(2 * muscles, unknowns), Eigen::VectorXd::Zero(2 * muscles)};
  for (Index m = 0; m < muscles; ++m) {
    entries.emplace_back(m, m, 1);
    entries.emplace_back(muscles + m, m, -1);
    rows.b[muscles + m] = -1;
  }
  rows.G.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

// minimize 1/2 sum weight_i v_i^2 under these equalities, with the first `muscles` unknowns between 0 and 1.
QuadraticProgram ProgramOf(const Eigen::VectorXd& weights, ConstraintRows equalities, Index muscles) {
  QuadraticProgram program;
  program.M.resize(weights.size(), weights.size());
  for (Index i = 0; i < weights.size(); ++i) program.M.insert(i, i) = weights[i];
  program.p = Eigen::VectorXd::Zero(weights.size());
  program.equalities = std::move(equalities);
  program.inequalities = Bounds(muscles, weights.size());
  return program;
}

// The solver's bounds hold to rounding; these hold exactly, so that an idle muscle has no activation at all.
Eigen::VectorXd WithinBounds(const QpSolution& solution, Index muscles) {
  if (solution.v.size() < muscles) return Eigen::VectorXd::Zero(muscles);
  Eigen::VectorXd activations = solution.v.head(muscles).cwiseMax(0).cwiseMin(1);
  if (static_cast<Index>(solution.active.size()) < 2 * muscles) return activations;
  for (Index m = 0; m < muscles; ++m) {
    if (solution.active[m]) activations[m] = 0;
    if (solution.active[muscles + m]) activations[m] = 1;
  }
  return activations;
}

}  // namespace

Distribution ForceDistributor::Solve(const Eigen::MatrixXd& capacity, const Eigen::VectorXd& demand) {
  const Index muscles = capacity.cols();
  const Eigen::VectorXd scale =
      muscles > 0 ? Eigen::VectorXd(capacity.cwiseAbs().rowwise().maxCoeff()) : Eigen::VectorXd::Zero(capacity.rows());
  const QpSettings settings{.solver = KktSolver::kDirect};
  QpSolution solution;
  Distribution result;
  QuadraticProgram program =
      ProgramOf(Eigen::VectorXd::Constant(muscles, 2), ScaledRows(capacity, demand, scale, false), muscles);
  if (static_cast<Index>(active_.size()) == 2 * muscles) solution.active = active_;
  const bool can_move_all = ((scale.array() > 0) || (demand.array() == 0)).all();
  result.feasible = can_move_all && SolveQp(program, settings, solution).status == QpStatus::kSolved;
  if (!result.feasible && muscles > 0) {
    const Index rows = program.equalities.count();
    Eigen::VectorXd weights = Eigen::VectorXd::Constant(muscles + rows, 1);
    weights.head(muscles).setConstant(kEffortBesideLack);
    program = ProgramOf(weights, ScaledRows(capacity, demand, scale, true), muscles);
    solution = QpSolution();
    SolveQp(program, settings, solution);
  }
  active_ = solution.active;
  result.activations = WithinBounds(solution, muscles);
  result.lack = demand - capacity * result.activations;
  return result;
}

}  // namespace fascicle
