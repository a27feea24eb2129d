#ifndef FASCICLE_CORE_LINALG_ACTIVE_SET_QP_H_
#define FASCICLE_CORE_LINALG_ACTIVE_SET_QP_H_

#include <Eigen/SparseCore>

#include <functional>
#include <vector>

#include "core/linalg/row_products.h"

namespace fascicle {

// Rows of linear constraints on n unknowns, with their right-hand sides.
struct ConstraintRows {
  RowMatrix G;        // m x n
  Eigen::VectorXd b;  // m

  Eigen::Index count() const { return b.size(); }
};

// minimize 1/2 v . M v - p . v
//   where  G_a v = b_a                       equalities, such as attachments
//          G_v v + E y_v = b_v               relaxed (stabilized) equalities with multipliers y_v, such as volumes
//          G_c v >= b_c                      inequalities, such as contacts
// [Fan 2013, 5.3]. Rows must not be zero; linearly dependent rows are allowed.
struct QuadraticProgram {
  Eigen::SparseMatrix<double> M;  // n x n, symmetric positive definite
  Eigen::VectorXd p;              // n
  // Adds A v to a product M v, where A is symmetric and positive semidefinite, and provides the diagonal of A. M + A
  // then takes the place of M, and only MINRES can solve. Null: no such term.
  std::function<void(const Eigen::VectorXd& v, Eigen::VectorXd& product)> add_product = nullptr;
  Eigen::VectorXd added_diagonal = {};
  ConstraintRows equalities, volumes, inequalities;
  // M v, or (M + A) v.
  Eigen::VectorXd Forces(const Eigen::VectorXd& v) const {
    Eigen::VectorXd product = M * v;
    if (add_product) add_product(v, product);
    return product;
  }

  Eigen::SparseMatrix<double> E;  // relaxation of the volumes: symmetric, positive semidefinite (eps L); empty: zero
  // For MINRES: the block of neighbouring volumes to which each volume belongs, counted from 0. The multipliers of a
  // block are corrected together, so that distant rows are coupled within one iteration [Nicolaides 1987]. Empty: no
  // blocks.
  std::vector<int> groups;
};

enum class KktSolver {
  kDirect,  // MUMPS: for small systems, and the reference for MINRES
  // A system on which MINRES fails is factored, if it is not too large.
  kMinres,  // block preconditioner: diag M, the diagonal of G_v (diag M)^-1 G_v^T + E with its `groups`, and S of
            // all other rows, factored. Where M is diagonal, v is eliminated and the system is that of the multipliers
};

struct QpSettings {
  KktSolver solver = KktSolver::kMinres;
  double tolerance = 1e-9;  // of the residuals of QpReport [1]
  int max_active_set_iterations = 500;
  int max_minres_iterations = 1000;  // of each system
  ThreadTeam* team = nullptr;        // shares the products; results have the same bits without it
};

// M v = p + G_a^T y_a + G_v^T y_v + G_c^T y_c, y_c >= 0, and y_c = 0 where an inequality is not active.
struct QpSolution {
  Eigen::VectorXd v;                             // n
  Eigen::VectorXd equalities, volumes, contact;  // multipliers y_a, y_v, y_c
  // Which inequalities are active, that is, hold as equalities. On input: those of a similar problem, or empty.
  std::vector<bool> active;
};

enum class QpStatus {
  kSolved,
  kInfeasible,    // the constraints have no solution, to working precision
  kNotConverged,  // iterations of the active set or of MINRES ran out
};

struct QpReport {
  QpStatus status = QpStatus::kNotConverged;
  int active_set_iterations = 0;
  std::vector<int> minres_iterations;  // of each system
  int factored = 0;                    // how many systems were factored
  // Residuals at the end: |M v - p - G^T y| over |M v| + |p|; the largest violation of a constraint over the largest
  // term of the constraints; the largest product of y_c and its inequality's slack, both scaled likewise.
  double stationarity = 0, feasibility = 0, complementarity = 0;
};

// Solves by primal-dual active sets [Hintermueller, Ito & Kunisch 2002; Ito & Kunisch 2008]: all inequalities with the
// wrong sign are exchanged at once, then the equality-constrained problem is solved again. Where that no longer reduces
// their number, they are exchanged one at a time [Judice & Pires 1994, block principal pivoting], which terminates. The
// same input gives the same bits for any number of threads.
QpReport SolveQp(const QuadraticProgram& problem, const QpSettings& settings, QpSolution& solution);

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_ACTIVE_SET_QP_H_
