#include "core/linalg/kkt_system.h"

#include <algorithm>
#include <limits>

#include "core/linalg/lower_triangle.h"
#include "core/linalg/minres.h"
#include "core/linalg/multiplier_preconditioner.h"

namespace fascicle {
namespace {

constexpr double kPressureRegularization = 1e-12;
constexpr int kDirectRefinements = 3;
// MINRES measures the residual in another norm than IsGood, so it may have to solve again for the remaining residual.
constexpr int kMostRefinements = 6;

// Selected rows of several matrices, stacked.
class RowStack {
 public:
  explicit RowStack(Eigen::Index columns) : columns_(columns) {}

  template <class IsChosen>
  void Add(const ConstraintRows& rows, const IsChosen& is_chosen) {
    for (Eigen::Index i = 0; i < rows.count(); ++i) {
      if (!is_chosen(i)) continue;
      for (RowMatrix::InnerIterator entry(rows.G, i); entry; ++entry) {
        column_.push_back(static_cast<int>(entry.col()));
        value_.push_back(entry.value());
      }
      begin_.push_back(static_cast<int>(column_.size()));
      right_.push_back(rows.b[i]);
    }
  }
  RowMatrix G() const {
    return Eigen::Map<const RowMatrix>(static_cast<Eigen::Index>(right_.size()), columns_, begin_.back(), begin_.data(),
                                       column_.data(), value_.data());
  }
  Eigen::VectorXd b() const {
    return Eigen::Map<const Eigen::VectorXd>(right_.data(), static_cast<Eigen::Index>(right_.size()));
  }

 private:
  Eigen::Index columns_;
  std::vector<int> begin_ = {0}, column_;
  std::vector<double> value_, right_;
};

bool IsDiagonal(const Eigen::SparseMatrix<double>& M) {
  if (M.nonZeros() != M.rows()) return false;
  for (Eigen::Index column = 0; column < M.cols(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(M, column); entry; ++entry) {
      if (entry.row() != column) return false;
    }
  }
  return true;
}

}  // namespace

KktSystem::KktSystem(const QuadraticProgram& problem, const std::vector<bool>& active, ThreadTeam* team)
    : problem_(&problem), volumes_(problem.volumes.count()), team_(team) {
  if (problem.equalities.count() == 0 && problem.inequalities.count() == 0 && volumes_ > 0) {
    G_ = &problem.volumes.G;
    b_ = problem.volumes.b;
  } else {
    const auto all = [](Eigen::Index) { return true; };
    RowStack rows(problem.p.size());
    rows.Add(problem.volumes, all);
    rows.Add(problem.equalities, all);
    rows.Add(problem.inequalities, [&](Eigen::Index i) { return active[static_cast<std::size_t>(i)]; });
    stacked_ = rows.G();
    G_ = &stacked_;
    b_ = rows.b();
  }
  transposed_ = Transposed(*G_, team);
  inverse_mass_ = problem.M.diagonal();
  if (problem.add_product) inverse_mass_ += problem.added_diagonal;
  inverse_mass_ = inverse_mass_.cwiseInverse().eval();
  schur_ = Eigen::VectorXd::Zero(G_->rows());
  const auto rows_of_schur = [&](std::size_t begin, std::size_t end) {
    for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i) {
      for (RowMatrix::InnerIterator entry(*G_, i); entry; ++entry) {
        schur_[i] += entry.value() * entry.value() * inverse_mass_[entry.col()];
      }
    }
  };
  InRanges(team, static_cast<std::size_t>(G_->rows()), kRowGrain, rows_of_schur);
  regularization_ = kPressureRegularization * schur_;
}

Eigen::VectorXd KktSystem::Side() const {
  Eigen::VectorXd side(problem_->p.size() + b_.size());
  side << problem_->p, b_;
  return side;
}

void KktSystem::Apply(const Eigen::VectorXd& x, double scale, Eigen::VectorXd& y) const {
  const Eigen::Index n = problem_->p.size(), m = b_.size();
  Eigen::VectorXd product;
  y.resize(n + m);
  Product(transposed_, x.tail(m), team_, product);
  y.head(n) = problem_->Forces(x.head(n)) + product;
  Product(*G_, x.head(n), team_, product);
  y.tail(m) = product;
  if (problem_->E.size() > 0) y.segment(n, volumes_) -= problem_->E * x.segment(n, volumes_);
  const Eigen::Index first = problem_->E.size() > 0 ? volumes_ : 0;
  y.tail(m - first) -= scale * regularization_.tail(m - first).cwiseProduct(x.tail(m - first));
}

KktSystem::Result KktSystem::SolveDirect() {
  const Eigen::Index n = problem_->p.size(), m = b_.size();
  const bool has_E = problem_->E.size() > 0;
  LowerTriangle lower;
  lower.Add(problem_->M, 0, 1);
  for (Eigen::Index i = 0; i < m; ++i) {
    for (RowMatrix::InnerIterator entry(*G_, i); entry; ++entry) lower.Add(n + i, entry.col(), entry.value());
  }
  if (has_E) lower.Add(problem_->E, n, -1);
  for (Eigen::Index i = has_E ? volumes_ : 0; i < m; ++i) lower.Add(n + i, n + i, -regularization_[i]);
  Result result;
  if (!lower.Factor(n + m, factors_)) return result;
  result.v = Eigen::VectorXd::Zero(n);
  result.y = Eigen::VectorXd::Zero(m);
  Improve(1, result);
  return result;
}

void KktSystem::RemoveRegularization(Result& result) { Improve(0, result); }

void KktSystem::Improve(double scale, Result& result) {
  const Eigen::Index n = problem_->p.size(), m = b_.size();
  Eigen::VectorXd x(n + m), product;
  x << result.v, -result.y;
  for (int k = 0; k < kDirectRefinements; ++k) {
    Apply(x, scale, product);
    product = Side() - product;
    factors_.Solve({product.data(), static_cast<std::size_t>(product.size())});
    x += product;
  }
  result.ok = x.allFinite();
  result.v = x.head(n);
  result.y = -x.tail(m);
}

KktSystem::Result KktSystem::SolveMinres(const QpSettings& settings) const {
  return IsDiagonal(problem_->M) && !problem_->add_product && b_.size() > 0 ? SolveMultipliers(settings)
                                                                            : SolveWhole(settings);
}

bool KktSystem::IsGood(Result& result, const QpSettings& settings) const {
  const Eigen::VectorXd forces = problem_->Forces(result.v);
  Eigen::VectorXd product;
  Product(transposed_, result.y, team_, product);
  const double left = (forces - problem_->p - product).norm(), size = forces.norm() + problem_->p.norm();
  result.stationarity = size > 0 ? left / size : 0;
  const bool balances = left <= settings.tolerance * std::max(problem_->p.norm(), forces.norm());
  result.feasibility = 0;
  if (b_.size() > 0) {
    Product(*G_, result.v, team_, product);
    product -= b_;
    if (problem_->E.size() > 0) product.head(volumes_) += problem_->E * result.y.head(volumes_);
    const double terms = std::max(
        {b_.lpNorm<Eigen::Infinity>(), LargestTerms(*G_, result.v, team_), std::numeric_limits<double>::min()});
    result.feasibility = product.lpNorm<Eigen::Infinity>() / terms;
  }
  return balances && result.feasibility <= settings.tolerance;
}

// (G M^-1 G^T + C) y = b - G M^-1 p, then v = M^-1 (p + G^T y).
KktSystem::Result KktSystem::SolveMultipliers(const QpSettings& settings) const {
  Result result;
  const MultiplierPreconditioner preconditioner(*problem_, *G_, volumes_, inverse_mass_, schur_, regularization_,
                                                team_);
  if (!preconditioner.ok()) return result;
  const RowMatrix E = problem_->E;  // symmetric: the same by rows
  Eigen::VectorXd v, of_volumes;
  const auto apply = [&](const Eigen::VectorXd& y, Eigen::VectorXd& product) {
    ProductWith(
        transposed_, y, team_, [&](Eigen::Index i, double sum) { return inverse_mass_[i] * sum; }, v);
    Product(*G_, v, team_, product);
    if (E.size() == 0) return;
    Product(E, y.head(volumes_), team_, of_volumes);
    product.head(volumes_) += of_volumes;
  };
  const auto precondition = [&](const Eigen::VectorXd& r, Eigen::VectorXd& z) {
    z.resize(r.size());
    preconditioner.Apply(r, z);
  };
  Eigen::VectorXd r, step, product;
  Product(*G_, inverse_mass_.cwiseProduct(problem_->p), team_, product);
  const Eigen::VectorXd side = b_ - product;
  r = side;
  result.y = Eigen::VectorXd::Zero(b_.size());
  for (int k = 0; k < kMostRefinements && !result.ok; ++k) {
    const MinresResult minres = Minres(apply, precondition, r, (k == 0 ? 1 : 0.1) * settings.tolerance,
                                       settings.max_minres_iterations - result.iterations, step);
    result.iterations += minres.iterations;
    result.y += step;
    apply(result.y, product);
    r = side - product;
    ProductWith(
        transposed_, result.y, team_,
        [&](Eigen::Index i, double sum) { return inverse_mass_[i] * (problem_->p[i] + sum); }, result.v);
    result.ok = IsGood(result, settings);
    if (!minres.converged && minres.iterations == 0) break;
  }
  return result;
}

KktSystem::Result KktSystem::SolveWhole(const QpSettings& settings) const {
  const Eigen::Index n = problem_->p.size(), m = b_.size();
  Result result;
  const MultiplierPreconditioner of_multipliers(*problem_, *G_, volumes_, inverse_mass_, schur_, regularization_,
                                                team_);
  if (!of_multipliers.ok()) return result;
  const auto precondition = [&](const Eigen::VectorXd& r, Eigen::VectorXd& z) {
    z.resize(n + m);
    z.head(n) = inverse_mass_.cwiseProduct(r.head(n));
    of_multipliers.Apply(r.tail(m), z.tail(m));
  };
  const auto apply = [this](const Eigen::VectorXd& x, Eigen::VectorXd& y) { Apply(x, 0, y); };
  const Eigen::VectorXd side = Side();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n + m), r = side, step, product;
  for (int k = 0; k < kMostRefinements && !result.ok; ++k) {
    const MinresResult minres = Minres(apply, precondition, r, (k == 0 ? 1 : 0.1) * settings.tolerance,
                                       settings.max_minres_iterations - result.iterations, step);
    result.iterations += minres.iterations;
    x += step;
    Apply(x, 0, product);
    r = side - product;
    result.v = x.head(n);
    result.y = -x.tail(m);
    result.ok = IsGood(result, settings);
    if (!minres.converged && minres.iterations == 0) break;
  }
  return result;
}

}  // namespace fascicle
