#include "core/linalg/kkt_system.h"

#include "core/linalg/minres.h"

namespace fascicle {
namespace {

using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

constexpr double kHair = 1e-12;
constexpr int kDirectRefinements = 3;
// The residual of MINRES is of another norm than that which counts: it solves again for what is left.
constexpr int kMostRefinements = 6;

// Rows that are chosen of all, one below the other.
class RowStack {
 public:
  explicit RowStack(Eigen::Index columns) : columns_(columns) {}

  template <class IsChosen>
  void Add(const ConstraintRows& rows, const IsChosen& is_chosen) {
    for (Eigen::Index i = 0; i < rows.count(); ++i) {
      if (!is_chosen(i)) continue;
      for (RowMatrix::InnerIterator entry(rows.G, i); entry; ++entry) {
        entries_.emplace_back(static_cast<int>(right_.size()), static_cast<int>(entry.col()), entry.value());
      }
      right_.push_back(rows.b[i]);
    }
  }
  RowMatrix G() const {
    RowMatrix matrix(static_cast<Eigen::Index>(right_.size()), columns_);
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    return matrix;
  }
  Eigen::VectorXd b() const {
    return Eigen::Map<const Eigen::VectorXd>(right_.data(), static_cast<Eigen::Index>(right_.size()));
  }

 private:
  Eigen::Index columns_;
  std::vector<Eigen::Triplet<double>> entries_;
  std::vector<double> right_;
};

// Triplets of a lower triangle, for MUMPS.
struct LowerTriangle {
  void Add(Eigen::Index row, Eigen::Index column, double value) {
    rows.push_back(static_cast<std::int32_t>(row));
    columns.push_back(static_cast<std::int32_t>(column));
    values.push_back(value);
  }
  bool Factor(Eigen::Index size, DirectSolver& solver) const {
    return solver.Analyze(static_cast<std::int32_t>(size), rows, columns) && solver.Factor(values).ok;
  }
  std::vector<std::int32_t> rows, columns;
  std::vector<double> values;
};

}  // namespace

KktSystem::KktSystem(const QuadraticProgram& problem, const std::vector<bool>& active)
    : problem_(&problem), volumes_(problem.volumes.count()) {
  const auto all = [](Eigen::Index) { return true; };
  RowStack rows(problem.p.size());
  rows.Add(problem.volumes, all);
  rows.Add(problem.equalities, all);
  rows.Add(problem.inequalities, [&](Eigen::Index i) { return active[static_cast<std::size_t>(i)]; });
  G_ = rows.G();
  b_ = rows.b();
  inverse_mass_ = problem.M.diagonal().cwiseInverse();
  schur_ = Eigen::VectorXd::Zero(G_.rows());
  for (Eigen::Index i = 0; i < G_.rows(); ++i) {
    for (RowMatrix::InnerIterator entry(G_, i); entry; ++entry) {
      schur_[i] += entry.value() * entry.value() * inverse_mass_[entry.col()];
    }
  }
  hair_ = kHair * schur_;
}

Eigen::VectorXd KktSystem::Side() const {
  Eigen::VectorXd side(problem_->p.size() + b_.size());
  side << problem_->p, b_;
  return side;
}

void KktSystem::Apply(const Eigen::VectorXd& x, double hair_part, Eigen::VectorXd& y) const {
  const Eigen::Index n = problem_->p.size(), m = b_.size();
  y.resize(n + m);
  y.head(n) = problem_->M * x.head(n) + G_.transpose() * x.tail(m);
  y.tail(m) = G_ * x.head(n);
  if (problem_->E.size() > 0) y.segment(n, volumes_) -= problem_->E * x.segment(n, volumes_);
  const Eigen::Index first = problem_->E.size() > 0 ? volumes_ : 0;
  y.tail(m - first) -= hair_part * hair_.tail(m - first).cwiseProduct(x.tail(m - first));
}

KktSystem::Result KktSystem::SolveDirect() {
  const Eigen::Index n = problem_->p.size(), m = b_.size();
  LowerTriangle lower;
  for (Eigen::Index column = 0; column < n; ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(problem_->M, column); entry; ++entry) {
      if (entry.row() >= column) lower.Add(entry.row(), column, entry.value());
    }
  }
  for (Eigen::Index i = 0; i < m; ++i) {
    for (RowMatrix::InnerIterator entry(G_, i); entry; ++entry) lower.Add(n + i, entry.col(), entry.value());
  }
  const bool has_E = problem_->E.size() > 0;
  for (Eigen::Index column = 0; column < volumes_ && has_E; ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(problem_->E, column); entry; ++entry) {
      if (entry.row() >= column) lower.Add(n + entry.row(), n + column, -entry.value());
    }
  }
  for (Eigen::Index i = has_E ? volumes_ : 0; i < m; ++i) lower.Add(n + i, n + i, -hair_[i]);
  Result result;
  if (!lower.Factor(n + m, factors_)) return result;
  result.v = Eigen::VectorXd::Zero(n);
  result.y = Eigen::VectorXd::Zero(m);
  Improve(1, result);
  return result;
}

void KktSystem::TakeOutHair(Result& result) { Improve(0, result); }

void KktSystem::Improve(double hair_part, Result& result) {
  const Eigen::Index n = problem_->p.size(), m = b_.size();
  Eigen::VectorXd x(n + m), product;
  x << result.v, -result.y;
  for (int k = 0; k < kDirectRefinements; ++k) {
    Apply(x, hair_part, product);
    product = Side() - product;
    factors_.Solve({product.data(), static_cast<std::size_t>(product.size())});
    x += product;
  }
  result.ok = x.allFinite();
  result.v = x.head(n);
  result.y = -x.tail(m);
}

KktSystem::Result KktSystem::SolveMinres(double tolerance, int max_iterations) const {
  const Eigen::Index n = problem_->p.size(), m = b_.size(), others = m - volumes_;
  Eigen::VectorXd of_volumes = schur_.head(volumes_);
  if (problem_->E.size() > 0) of_volumes += problem_->E.diagonal();
  of_volumes = of_volumes.cwiseInverse().eval();
  DirectSolver S;
  Result result;
  if (others > 0) {
    const RowMatrix rows = G_.bottomRows(others);
    const Eigen::SparseMatrix<double> product =
        rows * inverse_mass_.asDiagonal() * Eigen::SparseMatrix<double>(rows.transpose());
    LowerTriangle lower;
    for (Eigen::Index column = 0; column < others; ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator entry(product, column); entry; ++entry) {
        if (entry.row() < column) continue;
        lower.Add(entry.row(), column, entry.value() + (entry.row() == column ? hair_[volumes_ + column] : 0));
      }
    }
    if (!lower.Factor(others, S)) return result;
  }
  const auto precondition = [&](const Eigen::VectorXd& r, Eigen::VectorXd& z) {
    z.resize(n + m);
    z.head(n) = inverse_mass_.cwiseProduct(r.head(n));
    z.segment(n, volumes_) = of_volumes.cwiseProduct(r.segment(n, volumes_));
    z.tail(others) = r.tail(others);
    if (others > 0) S.Solve({z.data() + n + volumes_, static_cast<std::size_t>(others)});
  };
  const auto apply = [this](const Eigen::VectorXd& x, Eigen::VectorXd& y) { Apply(x, 0, y); };
  const Eigen::VectorXd side = Side();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n + m), r = side, step, product;
  const double goal_of_forces = tolerance * problem_->p.norm(), size = b_.size() > 0 ? b_.lpNorm<Eigen::Infinity>() : 0;
  for (int k = 0; k < kMostRefinements && !result.ok; ++k) {
    const MinresResult minres =
        Minres(apply, precondition, r, 0.1 * tolerance, max_iterations - result.iterations, step);
    result.iterations += minres.iterations;
    x += step;
    Apply(x, 0, product);
    r = side - product;
    const double terms = m == 0 ? 0 : std::max(size, (G_.cwiseAbs() * x.head(n).cwiseAbs()).eval().maxCoeff());
    result.ok = r.head(n).norm() <= std::max(goal_of_forces, tolerance * (problem_->M * x.head(n)).norm()) &&
                (m == 0 || r.tail(m).lpNorm<Eigen::Infinity>() <= tolerance * terms);
    if (!minres.converged && minres.iterations == 0) break;
  }
  result.v = x.head(n);
  result.y = -x.tail(m);
  return result;
}

}  // namespace fascicle
