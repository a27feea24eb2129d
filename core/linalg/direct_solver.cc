#include "core/linalg/direct_solver.h"

#include <dmumps_c.h>

#include <algorithm>
#include <mutex>
#include <vector>

#include "core/base/check.h"
#include "core/linalg/elimination_order.h"

namespace fascicle {
namespace {

constexpr int kInitialize = -1, kAnalyze = 1, kFactor = 2, kSolve = 3, kEnd = -2;
// What MUMPS takes for the communicator of all processes; there is only one process.
constexpr int kWorld = -987654;
// EliminationOrder's, which depends on nothing but the pattern.
constexpr int kGivenOrder = 1;
// Errors that more workspace can cure.
constexpr int kWorkspaceTooSmall = -9, kIntegerWorkspaceTooSmall = -8;
constexpr int kMostWorkspacePercent = 2000;

std::mutex& LibraryMutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

struct DirectSolver::Impl {
  Impl() {
    mumps.sym = 2;  // symmetric, not necessarily definite
    mumps.par = 1;
    mumps.comm_fortran = kWorld;
    Call(kInitialize);
    for (const int k : {1, 2, 3, 4}) Control(k) = k == 4 ? 0 : -1;  // prints nothing
    Control(7) = kGivenOrder;
    Control(14) = 60;  // [%] more workspace than estimated
    // Scaled to a unit diagonal, quasi-definite matrices need no pivoting, which would increase the fill-in.
    Control(8) = 1;
  }

  // Control parameters as numbered in the manual, from 1.
  MUMPS_INT& Control(int k) { return mumps.icntl[k - 1]; }

  bool Call(int job) {
    const std::lock_guard lock(LibraryMutex());
    mumps.job = job;
    dmumps_c(&mumps);
    return mumps.infog[0] >= 0;
  }

  DMUMPS_STRUC_C mumps = {};
  std::vector<MUMPS_INT> rows, columns, order;
  std::vector<double> values;
};

DirectSolver::DirectSolver() : impl_(std::make_unique<Impl>()) {}

DirectSolver::~DirectSolver() { impl_->Call(kEnd); }

bool DirectSolver::Analyze(std::int32_t size, std::span<const std::int32_t> rows,
                           std::span<const std::int32_t> columns) {
  Impl& d = *impl_;
  d.order = EliminationOrder(size, rows, columns);
  if (d.order.empty()) return false;
  for (MUMPS_INT& place : d.order) ++place;
  d.rows.assign(rows.begin(), rows.end());
  d.columns.assign(columns.begin(), columns.end());
  d.values.assign(rows.size(), 0.0);
  for (MUMPS_INT& row : d.rows) ++row;
  for (MUMPS_INT& column : d.columns) ++column;
  d.mumps.n = size;
  d.mumps.nnz = static_cast<MUMPS_INT8>(d.rows.size());
  d.mumps.irn = d.rows.data();
  d.mumps.jcn = d.columns.data();
  d.mumps.a = d.values.data();
  d.mumps.perm_in = d.order.data();
  return d.Call(kAnalyze);
}

DirectSolver::Factored DirectSolver::Factor(std::span<const double> values) {
  Impl& d = *impl_;
  FASCICLE_CHECK(values.size() == d.values.size(), "one value for each entry of the pattern");
  std::copy(values.begin(), values.end(), d.values.begin());
  bool ok = d.Call(kFactor);
  while (!ok && (d.mumps.infog[0] == kWorkspaceTooSmall || d.mumps.infog[0] == kIntegerWorkspaceTooSmall) &&
         d.Control(14) < kMostWorkspacePercent) {
    d.Control(14) *= 2;
    ok = d.Call(kFactor);
  }
  return {ok, d.mumps.infog[11]};
}

void DirectSolver::Solve(std::span<double> b) {
  Impl& d = *impl_;
  FASCICLE_CHECK(static_cast<MUMPS_INT>(b.size()) == d.mumps.n, "the right-hand side has the matrix's size");
  d.mumps.rhs = b.data();
  d.mumps.nrhs = 1;
  FASCICLE_CHECK(d.Call(kSolve), "a factored matrix solves");
}

}  // namespace fascicle
