#include "core/linalg/multiplier_preconditioner.h"

#include <algorithm>

#include "core/linalg/lower_triangle.h"

namespace fascicle {
namespace {

// The columns (ascending) and values of a row.
struct SparseRow {
  std::vector<int> column;
  std::vector<double> value;
};

// Sums up entries of a row and drops those that cancel. Holds a dense row, which is zero between two rows.
class RowSum {
 public:
  explicit RowSum(Eigen::Index columns)
      : sum_(static_cast<std::size_t>(columns), 0), size_(static_cast<std::size_t>(columns), 0) {}

  void Add(Eigen::Index column, double value) {
    const auto c = static_cast<std::size_t>(column);
    if (value == 0) return;
    if (size_[c] == 0) columns_.push_back(static_cast<int>(c));
    sum_[c] += value;
    size_[c] += std::abs(value);
  }
  SparseRow Take() {
    std::sort(columns_.begin(), columns_.end());
    SparseRow row;
    for (const int c : columns_) {
      if (std::abs(sum_[c]) > kCancelled * size_[c]) {
        row.column.push_back(c);
        row.value.push_back(sum_[c]);
      }
      sum_[c] = size_[c] = 0;
    }
    columns_.clear();
    return row;
  }

 private:
  static constexpr double kCancelled = 1e-12;
  std::vector<double> sum_, size_;
  std::vector<int> columns_;
};

// A matrix built by rows in parallel: add(i, sum) adds the entries of row i.
template <class Add>
RowMatrix ByRows(Eigen::Index count, Eigen::Index columns, ThreadTeam* team, const Add& add) {
  std::vector<SparseRow> rows(static_cast<std::size_t>(count));
  const auto make = [&](std::size_t begin, std::size_t end) {
    RowSum sum(columns);
    for (std::size_t i = begin; i < end; ++i) {
      add(i, sum);
      rows[i] = sum.Take();
    }
  };
  // One range per thread, because each range has a dense row of its own.
  const std::size_t threads = team != nullptr ? static_cast<std::size_t>(team->size()) : 1;
  InRanges(team, rows.size(), (rows.size() + threads - 1) / threads, make);
  RowMatrix matrix(count, columns);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    matrix.startVec(static_cast<Eigen::Index>(i));
    for (std::size_t k = 0; k < rows[i].column.size(); ++k) {
      matrix.insertBack(static_cast<Eigen::Index>(i), rows[i].column[k]) = rows[i].value[k];
    }
  }
  matrix.finalize();
  return matrix;
}

}  // namespace

MultiplierPreconditioner::MultiplierPreconditioner(const QuadraticProgram& problem, const RowMatrix& G,
                                                   Eigen::Index volumes, const Eigen::VectorXd& inverse_mass,
                                                   const Eigen::VectorXd& schur, const Eigen::VectorXd& regularization,
                                                   ThreadTeam* team)
    : volumes_(volumes),
      others_(G.rows() - volumes),
      of_volumes_(schur.head(volumes)),
      groups_(problem.groups),
      team_(team) {
  if (problem.E.size() > 0) of_volumes_ += problem.E.diagonal();
  of_volumes_ = of_volumes_.cwiseInverse().eval();
  if (!groups_.empty()) ok_ = FactorGroups(problem, G, inverse_mass);
  if (others_ > 0) ok_ &= FactorOthers(G, inverse_mass, regularization);
}

bool MultiplierPreconditioner::FactorGroups(const QuadraticProgram& problem, const RowMatrix& G,
                                            const Eigen::VectorXd& inverse_mass) {
  members_.resize(static_cast<std::size_t>(*std::max_element(groups_.begin(), groups_.end()) + 1));
  for (std::size_t i = 0; i < groups_.size(); ++i) members_[groups_[i]].push_back(static_cast<Eigen::Index>(i));
  const RowMatrix rows = ByRows(group_count(), G.cols(), team_, [&](std::size_t g, RowSum& sum) {
    for (const Eigen::Index i : members_[g]) {
      for (RowMatrix::InnerIterator entry(G, i); entry; ++entry) sum.Add(entry.col(), entry.value());
    }
  });
  const RowMatrix columns = Transposed(rows, team_);
  const RowMatrix product = ByRows(group_count(), group_count(), team_, [&](std::size_t g, RowSum& sum) {
    for (RowMatrix::InnerIterator entry(rows, static_cast<Eigen::Index>(g)); entry; ++entry) {
      const double weight = entry.value() * inverse_mass[entry.col()];
      for (RowMatrix::InnerIterator other(columns, entry.col()); other; ++other) {
        sum.Add(other.col(), weight * other.value());
      }
    }
    if (problem.E.size() == 0) return;
    for (const Eigen::Index i : members_[g]) {
      for (Eigen::SparseMatrix<double>::InnerIterator entry(problem.E, i); entry; ++entry) {
        sum.Add(groups_[static_cast<std::size_t>(entry.row())], entry.value());
      }
    }
  });
  Eigen::SparseMatrix<double> matrix = product;
  // The pressure of a body without supports may have a null space.
  const double regularization = 1e-9 * matrix.diagonal().maxCoeff();
  for (Eigen::Index g = 0; g < group_count(); ++g) matrix.coeffRef(g, g) += regularization;
  coarse_.compute(matrix);
  return coarse_.info() == Eigen::Success;
}

bool MultiplierPreconditioner::FactorOthers(const RowMatrix& G, const Eigen::VectorXd& inverse_mass,
                                            const Eigen::VectorXd& regularization) {
  const RowMatrix rows = G.bottomRows(others_);
  Eigen::SparseMatrix<double> matrix = rows * inverse_mass.asDiagonal() * Eigen::SparseMatrix<double>(rows.transpose());
  for (Eigen::Index k = 0; k < others_; ++k) matrix.coeffRef(k, k) += regularization[volumes_ + k];
  LowerTriangle lower;
  lower.Add(matrix, 0, 1);
  return lower.Factor(others_, S_);
}

void MultiplierPreconditioner::Apply(const Eigen::Ref<const Eigen::VectorXd>& r, Eigen::Ref<Eigen::VectorXd> z) const {
  const auto in_parallel = [this](Eigen::Index count, std::size_t grain, const auto& body) {
    InRanges(team_, static_cast<std::size_t>(count), grain, [&](std::size_t begin, std::size_t end) {
      for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i) body(i);
    });
  };
  Eigen::VectorXd of_groups(group_count());
  in_parallel(group_count(), 16, [&](Eigen::Index g) {
    of_groups[g] = 0;
    for (const Eigen::Index i : members_[static_cast<std::size_t>(g)]) of_groups[g] += r[i];
  });
  if (group_count() > 0) of_groups = coarse_.solve(of_groups).eval();
  in_parallel(volumes_, 2048, [&](Eigen::Index i) {
    z[i] = of_volumes_[i] * r[i];
    if (group_count() > 0) z[i] += of_groups[groups_[static_cast<std::size_t>(i)]];
  });
  if (others_ == 0) return;
  z.tail(others_) = r.tail(others_);
  S_.Solve({z.data() + volumes_, static_cast<std::size_t>(others_)});
}

}  // namespace fascicle
