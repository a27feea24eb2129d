#ifndef FASCICLE_CORE_LINALG_ACTIVE_SET_QP_H_
#define FASCICLE_CORE_LINALG_ACTIVE_SET_QP_H_

#include <Eigen/SparseCore>

#include <functional>
#include <vector>

#include "core/linalg/row_products.h"

namespace fascicle {

// Rows of constraints on n unknowns, and their right sides.
struct ConstraintRows {
  RowMatrix G;        // m x n
  Eigen::VectorXd b;  // m

  Eigen::Index count() const { return b.size(); }
};

// minimize 1/2 v . M v - p . v
//   where  G_a v = b_a                       equalities, such as attachments
//          G_v v + E y_v = b_v               equalities that give way by their multipliers y_v, such as volumes
//          G_c v >= b_c                      inequalities, such as contacts
// [Fan 2013, 3.5]. Rows must not be zero; those that depend on others do no harm.
struct QuadraticProgram {
  Eigen::SparseMatrix<double> M;  // n x n, symmetric positive definite
  Eigen::VectorXd p;              // n
  // Adds A v to a product M v, A symmetric and positive semidefinite, with its diagonal: then M + A stands for M, and
  // only MINRES solves. Null: nothing.
  std::function<void(const Eigen::VectorXd& v, Eigen::VectorXd& product)> add_product = nullptr;
  Eigen::VectorXd added_diagonal = {};
  ConstraintRows equalities, volumes, inequalities;
  // M v, or (M + A) v.
  Eigen::VectorXd Forces(const Eigen::VectorXd& v) const {
    Eigen::VectorXd product = M * v;
    if (add_product) add_product(v, product);
    return product;
  }

  Eigen::SparseMatrix<double> E;  // of volumes: symmetric, positive semidefinite (eps L); empty: zero
  // Of volumes, for MINRES: the block of neighbours that each belongs to, counted from 0. Their multipliers are
  // corrected block by block together, so that far rows hear of each other at once [Nicolaides 1987]. Empty: none.
  std::vector<int> groups;
};

enum class KktSolver {
  kDirect,  // MUMPS: small systems, and what MINRES is measured against
  // Systems that it does not solve in its iterations are factored after all, where they are not too large.
  kMinres,  // preconditioned by blocks: diag M, the diagonal of G_v (diag M)^-1 G_v^T + E with its `groups`, and S of
            // all other rows, factored. Where M is diagonal, v is taken out, and the system is that of the multipliers
};

struct QpSettings {
  KktSolver solver = KktSolver::kMinres;
  double tolerance = 1e-9;  // of the residuals of QpReport [1]
  int max_active_set_iterations = 500;
  int max_minres_iterations = 1000;  // of each system
  ThreadTeam* team = nullptr;        // shares the products; the bits are the same without
};

// M v = p + G_a^T y_a + G_v^T y_v + G_c^T y_c, y_c >= 0, and y_c = 0 where an inequality is not active.
struct QpSolution {
  Eigen::VectorXd v;                             // n
  Eigen::VectorXd equalities, volumes, contact;  // multipliers y_a, y_v, y_c
  // Which inequalities hold as equalities. As a start: those of a problem that is near, or empty.
  std::vector<bool> active;
};

enum class QpStatus {
  kSolved,
  kInfeasible,    // no v meets all constraints, as far as numbers can tell
  kNotConverged,  // iterations of the active set or of MINRES ran out
};

struct QpReport {
  QpStatus status = QpStatus::kNotConverged;
  int active_set_iterations = 0;
  std::vector<int> minres_iterations;  // of each of them
  int factored = 0;                    // how many of them were solved by factors
  // At the end. |M v - p - G^T y| over |M v| + |p|; the largest violation of a constraint over the largest of the terms
  // that make constraints; the largest product of y_c and what is left of its inequality, both scaled as these.
  double stationarity = 0, feasibility = 0, complementarity = 0;
};

// By primal-dual active sets [Hintermueller, Ito & Kunisch 2002; Ito & Kunisch 2008]: all inequalities whose sign is
// wrong change sides at once, and the equality constrained problem is solved again. Where that no longer lessens their
// number, one at a time [Judice & Pires 1994, block principal pivoting], which comes to an end. The same input gives
// the same bits, for any number of threads.
QpReport SolveQp(const QuadraticProgram& problem, const QpSettings& settings, QpSolution& solution);

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_ACTIVE_SET_QP_H_
