// Quadratic programs against their optimality conditions, and MINRES against the direct solver.
#include "core/linalg/active_set_qp.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <random>
#include <sstream>

namespace fascicle {
namespace {

using Eigen::VectorXd;
using Triplets = std::vector<Eigen::Triplet<double>>;

std::string Text(const QpReport& r) {
  std::ostringstream out;
  out << r.active_set_iterations << " active sets, stationarity " << r.stationarity << ", feasibility " << r.feasibility
      << ", complementarity " << r.complementarity;
  return out.str();
}

class RandomProblems {
 public:
  explicit RandomProblems(unsigned seed) : random_(seed) {}

  // Some v meets all constraints; many inequalities are active there.
  QuadraticProgram Next() {
    const int n = Whole(3, 40);
    QuadraticProgram problem;
    problem.M = Mass(n);
    problem.p = Vector(n);
    const VectorXd inside = Vector(n);
    problem.equalities = Rows(Whole(0, n / 4), n, inside);
    problem.volumes = Rows(Whole(0, n / 4), n, inside);
    problem.inequalities = Rows(Whole(1, n), n, inside);
    for (double& b : problem.inequalities.b) b -= Whole(0, 1) * std::abs(normal_(random_));
    const auto volumes = static_cast<int>(problem.volumes.count());
    if (Whole(0, 1) == 1 && volumes > 0) {
      const Eigen::SparseMatrix<double> half = Rows(volumes, volumes, VectorXd::Zero(volumes)).G;
      problem.E = 0.01 * (half * Eigen::SparseMatrix<double>(half.transpose()));
    }
    return problem;
  }

 private:
  int Whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  VectorXd Vector(int n) {
    VectorXd v(n);
    for (double& x : v) x = normal_(random_);
    return v;
  }
  // Diagonal in half of the problems.
  Eigen::SparseMatrix<double> Mass(int n) {
    Triplets entries;
    for (int i = 0; i < n; ++i) entries.emplace_back(i, i, std::pow(10.0, 1.5 * normal_(random_)));
    Eigen::SparseMatrix<double> M(n, n);
    M.setFromTriplets(entries.begin(), entries.end());
    if (Whole(0, 1) == 0) return M;
    const Eigen::SparseMatrix<double> half = Rows(n, n, VectorXd::Zero(n)).G;
    return M + 0.1 * Eigen::SparseMatrix<double>(half * Eigen::SparseMatrix<double>(half.transpose()));
  }
  ConstraintRows Rows(int count, int n, const VectorXd& inside) {
    Triplets entries;
    for (int i = 0; i < count; ++i) {
      entries.emplace_back(i, i % n, 1 + std::abs(normal_(random_)));
      for (int k = 0; k < 3; ++k) entries.emplace_back(i, Whole(0, n - 1), normal_(random_));
    }
    ConstraintRows rows;
    rows.G.resize(count, n);
    rows.G.setFromTriplets(entries.begin(), entries.end());
    rows.b = rows.G * inside;
    return rows;
  }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

// Karush-Kuhn-Tucker conditions, to 1e-8 of the terms in them. Returns the number of active inequalities.
int ExpectOptimal(const QuadraticProgram& problem, const QpSolution& s) {
  constexpr double kTolerance = 1e-8;
  VectorXd pull = problem.p;
  double terms = problem.p.norm() + (problem.M * s.v).norm();
  const auto add = [&](const ConstraintRows& rows, const VectorXd& y) {
    if (rows.count() == 0) return;
    pull += rows.G.transpose() * y;
    terms += (rows.G.transpose() * y).norm();
  };
  add(problem.equalities, s.equalities);
  add(problem.volumes, s.volumes);
  add(problem.inequalities, s.contact);
  EXPECT_LE((problem.M * s.v - pull).norm(), kTolerance * terms);
  const double size = 1 + s.v.norm();
  const auto excess = [&](const ConstraintRows& rows) { return VectorXd(rows.G * s.v - rows.b); };
  if (problem.equalities.count() > 0) {
    EXPECT_LE(excess(problem.equalities).norm(), kTolerance * size);
  }
  if (problem.volumes.count() > 0) {
    VectorXd volumes = excess(problem.volumes);
    if (problem.E.size() > 0) volumes += problem.E * s.volumes;
    EXPECT_LE(volumes.norm(), kTolerance * size);
  }
  const VectorXd gap = excess(problem.inequalities);
  const double largest = std::max(1.0, s.contact.lpNorm<Eigen::Infinity>());
  int pulling = 0;
  for (Eigen::Index i = 0; i < gap.size(); ++i) {
    EXPECT_GE(gap[i], -kTolerance * size);
    EXPECT_GE(s.contact[i], -kTolerance * largest);
    EXPECT_LE(std::abs(gap[i] * s.contact[i]), kTolerance * size * largest);
    pulling += s.contact[i] > 1e-6 * largest;
  }
  return pulling;
}

TEST(ActiveSetQp, AThousandRandomProblems) {
  RandomProblems problems(7);
  int pulling = 0, most = 0, systems = 0, factored = 0;
  double difference = 0;
  for (int k = 0; k < 1000; ++k) {
    SCOPED_TRACE(k);
    const QuadraticProgram problem = problems.Next();
    QpSolution direct, minres;
    const QpReport of_direct = SolveQp(problem, {.solver = KktSolver::kDirect}, direct);
    ASSERT_EQ(of_direct.status, QpStatus::kSolved) << Text(of_direct);
    pulling += ExpectOptimal(problem, direct);
    const QpReport of_minres = SolveQp(problem, {.solver = KktSolver::kMinres, .tolerance = 1e-10}, minres);
    ASSERT_EQ(of_minres.status, QpStatus::kSolved) << Text(of_minres);
    ExpectOptimal(problem, minres);
    systems += of_minres.active_set_iterations;
    factored += of_minres.factored;
    difference = std::max(difference, (direct.v - minres.v).norm() / (1 + direct.v.norm()));
    most = std::max(most, of_direct.active_set_iterations);
    // Started at the solution, no constraint is exchanged.
    EXPECT_EQ(SolveQp(problem, {.solver = KktSolver::kDirect}, direct).active_set_iterations, 1);
    if (HasFailure()) break;
  }
  std::printf(
      "%d inequalities pull, at most %d active sets, MINRES and MUMPS differ by %.1e, %d of %d systems factored\n",
      pulling, most, difference, factored, systems);
  EXPECT_LT(factored, systems / 20);  // non-diagonal masses over nine decades are hard for MINRES
  EXPECT_GT(pulling, 3000);
  EXPECT_LT(difference, 1e-7);
}

// Rows g v >= b of a single v, whose unconstrained minimum is 0.
QuadraticProgram Line(const std::vector<std::array<double, 2>>& rows) {
  QuadraticProgram problem;
  problem.M.resize(1, 1);
  problem.M.insert(0, 0) = 2;
  problem.p = VectorXd::Zero(1);
  problem.inequalities.G.resize(static_cast<Eigen::Index>(rows.size()), 1);
  problem.inequalities.b.resize(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    problem.inequalities.G.insert(static_cast<Eigen::Index>(i), 0) = rows[i][0];
    problem.inequalities.b[static_cast<Eigen::Index>(i)] = rows[i][1];
  }
  return problem;
}

TEST(ActiveSetQp, RowsThatSayTheSameDoNoHarm) {
  for (const KktSolver solver : {KktSolver::kDirect, KktSolver::kMinres}) {
    const QuadraticProgram problem = Line({{1, 3}, {2, 6}, {1, 3}, {1, -5}});
    QpSolution solution;
    EXPECT_EQ(SolveQp(problem, {.solver = solver}, solution).status, QpStatus::kSolved);
    EXPECT_NEAR(solution.v[0], 3, 1e-9);
    ExpectOptimal(problem, solution);
  }
}

TEST(ActiveSetQp, WhatCanNotBeMetIsTold) {
  for (const KktSolver solver : {KktSolver::kDirect, KktSolver::kMinres}) {
    QpSolution solution;
    EXPECT_EQ(SolveQp(Line({{1, 3}, {-1, -2}}), {.solver = solver}, solution).status, QpStatus::kInfeasible);
  }
}

TEST(ActiveSetQp, TheSameBitsAgain) {
  RandomProblems problems(11);
  const QuadraticProgram problem = problems.Next();
  QpSolution first, second;
  SolveQp(problem, {}, first);
  SolveQp(problem, {}, second);
  EXPECT_EQ(first.v, second.v);
  EXPECT_EQ(first.contact, second.contact);
}

// A block on a grid of nodes as in the eulerian method: lumped masses, slivers at the surface, one volume constraint
// per cell regularized by eps L, supported at the bottom, pressed against a wall at the top.
QuadraticProgram Block(int nodes) {
  const int cells = nodes - 1, n = 3 * nodes * nodes * nodes;
  const auto node = [=](int i, int j, int k) { return i + nodes * (j + nodes * k); };
  const auto cell = [=](int i, int j, int k) { return i + cells * (j + cells * k); };
  const double h = 0.1 / cells, density = 1000;
  QuadraticProgram problem;
  Triplets mass, volumes, laplacian, held, wall;
  std::vector<double> of_node(static_cast<std::size_t>(n / 3), 0);
  for (int k = 0; k < cells; ++k) {
    for (int j = 0; j < cells; ++j) {
      for (int i = 0; i < cells; ++i) {
        const int blocks = (cells + 3) / 4;
        problem.groups.push_back(i / 4 + blocks * (j / 4 + blocks * (k / 4)));
        const bool is_surface = i == 0 || j == 0 || i == cells - 1 || j == cells - 1;
        const double part = is_surface ? 0.3 : 1;
        for (int c = 0; c < 8; ++c) {
          const int at = node(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
          of_node[static_cast<std::size_t>(at)] += part * density * h * h * h / 8;
          for (int d = 0; d < 3; ++d)
            volumes.emplace_back(cell(i, j, k), 3 * at + d, (c >> d & 1 ? 1 : -1) * part * h * h / 4);
        }
        const double weight = 0.05 * h / density;  // as in core/eulerian
        const auto couple = [&](int other) {
          laplacian.emplace_back(cell(i, j, k), cell(i, j, k), weight);
          laplacian.emplace_back(cell(i, j, k), other, -weight);
        };
        if (i > 0) couple(cell(i - 1, j, k));
        if (j > 0) couple(cell(i, j - 1, k));
        if (k > 0) couple(cell(i, j, k - 1));
        if (i + 1 < cells) couple(cell(i + 1, j, k));
        if (j + 1 < cells) couple(cell(i, j + 1, k));
        if (k + 1 < cells) couple(cell(i, j, k + 1));
      }
    }
  }
  for (int i = 0; i < n; ++i) mass.emplace_back(i, i, of_node[static_cast<std::size_t>(i / 3)]);
  int rows = 0;
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      for (int d = 0; d < 3; ++d, ++rows) {
        for (int c = 0; c < 4; ++c) held.emplace_back(rows, 3 * node(i + (c & 1), j + (c >> 1), 0) + d, h * h / 4);
      }
      for (int c = 0; c < 4; ++c)
        wall.emplace_back(cell(i, j, 0), 3 * node(i + (c & 1), j + (c >> 1), nodes - 1) + 2, -h * h / 4);
    }
  }
  const auto set = [](auto& matrix, int count, int columns, const Triplets& entries) {
    matrix.resize(count, columns);
    matrix.setFromTriplets(entries.begin(), entries.end());
  };
  set(problem.M, n, n, mass);
  set(problem.volumes.G, cells * cells * cells, n, volumes);
  set(problem.E, cells * cells * cells, cells * cells * cells, laplacian);
  set(problem.equalities.G, rows, n, held);
  set(problem.inequalities.G, cells * cells, n, wall);
  problem.volumes.b = VectorXd::Zero(problem.volumes.G.rows());
  problem.equalities.b = VectorXd::Zero(rows);
  problem.inequalities.b = VectorXd::Zero(cells * cells);
  VectorXd v(n);
  for (int k = 0; k < nodes; ++k) {
    for (int j = 0; j < nodes; ++j) {
      for (int i = 0; i < nodes; ++i) {
        const double x = 2.0 * i / cells - 1, y = 2.0 * j / cells - 1;
        v.segment<3>(3 * node(i, j, k)) << 0.2 * y, -0.1 * x, 1.5 * (x + 0.2);
      }
    }
  }
  problem.p = problem.M * v;
  return problem;
}

// Beside the thesis's 68, 62 and 56 iterations for 3,546, 13,851 and 68,529 unknowns [Fan 2013, table 6.2].
TEST(ActiveSetQp, MinresIterationsOfABlockOnAGrid) {
  for (const int nodes : {10, 17, 28}) {
    const QuadraticProgram problem = Block(nodes);
    QpSolution solution;
    const QpReport report = SolveQp(problem, {.tolerance = 1e-8}, solution);
    EXPECT_EQ(report.status, QpStatus::kSolved);
    std::printf("%ld unknowns, %ld constraints: %d active sets, MINRES iterations", problem.p.size(),
                problem.equalities.count() + problem.volumes.count() + problem.inequalities.count(),
                report.active_set_iterations);
    for (const int iterations : report.minres_iterations) std::printf(" %d", iterations);
    std::printf(", stationarity %.1e, feasibility %.1e\n", report.stationarity, report.feasibility);
    // Part of the wall is in contact.
    const auto touched = std::count(solution.active.begin(), solution.active.end(), true);
    EXPECT_GT(touched, problem.inequalities.count() / 4);
    EXPECT_LT(touched, problem.inequalities.count());
    QpSolution warm;
    warm.active = solution.active;
    EXPECT_EQ(SolveQp(problem, {.tolerance = 1e-8}, warm).active_set_iterations, 1);
  }
}

}  // namespace
}  // namespace fascicle
