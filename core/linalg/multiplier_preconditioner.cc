#include "core/linalg/multiplier_preconditioner.h"

#include <algorithm>

#include "core/linalg/lower_triangle.h"

namespace fascicle {
namespace {

// Sums the entries of rows and columns that belong to the same group.
Eigen::SparseMatrix<double> Grouped(const Eigen::SparseMatrix<double>& matrix, const std::vector<int>& groups,
                                    Eigen::Index count) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, column); entry; ++entry) {
      const int row = groups[static_cast<std::size_t>(entry.row())], col = groups[static_cast<std::size_t>(column)];
      if (row != col || entry.value() != 0) entries.emplace_back(row, col, entry.value());
    }
  }
  Eigen::SparseMatrix<double> sums(count, count);
  sums.setFromTriplets(entries.begin(), entries.end());
  return sums;
}

// The columns and values of a row, ascending.
struct SparseRow {
  std::vector<int> column;
  std::vector<double> value;
};

// Sums chosen rows of G without what cancels. Holds a dense row, which is zero between two sums.
class RowSum {
 public:
  explicit RowSum(Eigen::Index columns)
      : sum_(static_cast<std::size_t>(columns), 0), size_(static_cast<std::size_t>(columns), 0) {}

  SparseRow Of(const RowMatrix& G, const std::vector<Eigen::Index>& rows) {
    std::vector<int> columns;
    for (const Eigen::Index row : rows) {
      for (RowMatrix::InnerIterator entry(G, row); entry; ++entry) {
        const auto c = static_cast<std::size_t>(entry.col());
        if (size_[c] == 0) columns.push_back(static_cast<int>(c));
        sum_[c] += entry.value();
        size_[c] += std::abs(entry.value());
      }
    }
    std::sort(columns.begin(), columns.end());
    SparseRow result;
    for (const int c : columns) {
      if (std::abs(sum_[c]) > kCancelled * size_[c]) {
        result.column.push_back(c);
        result.value.push_back(sum_[c]);
      }
      sum_[c] = size_[c] = 0;
    }
    return result;
  }

 private:
  static constexpr double kCancelled = 1e-12;
  std::vector<double> sum_, size_;
};

// Row g: the sum of the first rows of G whose group is g.
RowMatrix GroupedRows(const RowMatrix& G, const std::vector<int>& groups, Eigen::Index count, ThreadTeam* team) {
  std::vector<std::vector<Eigen::Index>> members(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < groups.size(); ++i) members[groups[i]].push_back(static_cast<Eigen::Index>(i));
  std::vector<SparseRow> rows(members.size());
  const auto sum_groups = [&](std::size_t begin, std::size_t end) {
    RowSum sum(G.cols());
    for (std::size_t g = begin; g < end; ++g) rows[g] = sum.Of(G, members[g]);
  };
  // As few ranges as threads: each has a dense row of its own.
  const std::size_t threads = team != nullptr ? static_cast<std::size_t>(team->size()) : 1;
  team != nullptr ? team->For(rows.size(), (rows.size() + threads - 1) / threads, sum_groups)
                  : sum_groups(0, rows.size());
  RowMatrix sums(count, G.cols());
  for (std::size_t g = 0; g < rows.size(); ++g) {
    sums.startVec(static_cast<Eigen::Index>(g));
    for (std::size_t k = 0; k < rows[g].column.size(); ++k) {
      sums.insertBack(static_cast<Eigen::Index>(g), rows[g].column[k]) = rows[g].value[k];
    }
  }
  sums.finalize();
  return sums;
}

}  // namespace

MultiplierPreconditioner::MultiplierPreconditioner(const QuadraticProgram& problem, const RowMatrix& G,
                                                   Eigen::Index volumes, const Eigen::VectorXd& inverse_mass,
                                                   const Eigen::VectorXd& schur, const Eigen::VectorXd& hair,
                                                   ThreadTeam* team)
    : volumes_(volumes), others_(G.rows() - volumes), of_volumes_(schur.head(volumes)), groups_(problem.groups) {
  if (problem.E.size() > 0) of_volumes_ += problem.E.diagonal();
  of_volumes_ = of_volumes_.cwiseInverse().eval();
  if (!groups_.empty()) ok_ = FactorGroups(problem, G, inverse_mass, team);
  if (others_ > 0) ok_ &= FactorOthers(G, inverse_mass, hair);
}

bool MultiplierPreconditioner::FactorGroups(const QuadraticProgram& problem, const RowMatrix& G,
                                            const Eigen::VectorXd& inverse_mass, ThreadTeam* team) {
  group_count_ = *std::max_element(groups_.begin(), groups_.end()) + 1;
  const RowMatrix rows = GroupedRows(G, groups_, group_count_, team);
  Eigen::SparseMatrix<double> matrix = rows * inverse_mass.asDiagonal() * Eigen::SparseMatrix<double>(rows.transpose());
  if (problem.E.size() > 0) matrix += Grouped(problem.E, groups_, group_count_);
  // A body that nothing holds may have a pressure of its own that changes nothing.
  const double hair = 1e-9 * matrix.diagonal().maxCoeff();
  for (Eigen::Index g = 0; g < group_count_; ++g) matrix.coeffRef(g, g) += hair;
  coarse_.compute(matrix);
  return coarse_.info() == Eigen::Success;
}

bool MultiplierPreconditioner::FactorOthers(const RowMatrix& G, const Eigen::VectorXd& inverse_mass,
                                            const Eigen::VectorXd& hair) {
  const RowMatrix rows = G.bottomRows(others_);
  Eigen::SparseMatrix<double> matrix = rows * inverse_mass.asDiagonal() * Eigen::SparseMatrix<double>(rows.transpose());
  for (Eigen::Index k = 0; k < others_; ++k) matrix.coeffRef(k, k) += hair[volumes_ + k];
  LowerTriangle lower;
  lower.Add(matrix, 0, 1);
  return lower.Factor(others_, S_);
}

void MultiplierPreconditioner::Apply(const Eigen::Ref<const Eigen::VectorXd>& r, Eigen::Ref<Eigen::VectorXd> z) const {
  z.head(volumes_) = of_volumes_.cwiseProduct(r.head(volumes_));
  if (group_count_ > 0) {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(group_count_);
    for (Eigen::Index i = 0; i < volumes_; ++i) sums[groups_[static_cast<std::size_t>(i)]] += r[i];
    sums = coarse_.solve(sums).eval();
    for (Eigen::Index i = 0; i < volumes_; ++i) z[i] += sums[groups_[static_cast<std::size_t>(i)]];
  }
  if (others_ == 0) return;
  z.tail(others_) = r.tail(others_);
  S_.Solve({z.data() + volumes_, static_cast<std::size_t>(others_)});
}

}  // namespace fascicle
