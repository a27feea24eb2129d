#include "core/linalg/mumps_factors.h"

#include <dmumps_c.h>

#include <algorithm>
#include <vector>

#include "core/base/check.h"

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

}  // namespace

std::mutex& MumpsMutex() {
  static std::mutex mutex;
  return mutex;
}

struct MumpsFactors::Impl {
  // Control parameters as numbered in the manual, from 1.
  MUMPS_INT& Control(int k) { return mumps.icntl[k - 1]; }

  bool Call(int job) {
    mumps.job = job;
    dmumps_c(&mumps);
    return mumps.infog[0] >= 0;
  }

  DMUMPS_STRUC_C mumps = {};
  std::vector<MUMPS_INT> rows, columns, order;
  std::vector<double> values;
};

MumpsFactors::MumpsFactors() : impl_(std::make_unique<Impl>()) {
  Impl& m = *impl_;
  m.mumps.sym = 2;  // symmetric, not necessarily definite
  m.mumps.par = 1;
  m.mumps.comm_fortran = kWorld;
  m.Call(kInitialize);
  for (const int k : {1, 2, 3, 4}) m.Control(k) = k == 4 ? 0 : -1;  // prints nothing
  m.Control(7) = kGivenOrder;
  m.Control(14) = 60;  // [%] more workspace than estimated
  // Scaled to a unit diagonal, quasi-definite matrices need no pivoting, which would increase the fill-in.
  m.Control(8) = 1;
}

MumpsFactors::~MumpsFactors() { impl_->Call(kEnd); }

bool MumpsFactors::Analyze(std::span<const std::int32_t> order, std::span<const std::int32_t> rows,
                           std::span<const std::int32_t> columns) {
  Impl& m = *impl_;
  m.order.assign(order.begin(), order.end());
  m.rows.assign(rows.begin(), rows.end());
  m.columns.assign(columns.begin(), columns.end());
  m.values.assign(rows.size(), 0.0);
  for (std::vector<MUMPS_INT>* numbers : {&m.order, &m.rows, &m.columns}) {
    for (MUMPS_INT& number : *numbers) ++number;
  }
  m.mumps.n = static_cast<MUMPS_INT>(m.order.size());
  m.mumps.nnz = static_cast<MUMPS_INT8>(m.rows.size());
  m.mumps.irn = m.rows.data();
  m.mumps.jcn = m.columns.data();
  m.mumps.a = m.values.data();
  m.mumps.perm_in = m.order.data();
  return m.Call(kAnalyze);
}

DirectSolver::Factored MumpsFactors::Factor(std::span<const double> values) {
  Impl& m = *impl_;
  FASCICLE_CHECK(values.size() == m.values.size(), "one value for each entry of the pattern");
  std::copy(values.begin(), values.end(), m.values.begin());
  bool ok = m.Call(kFactor);
  while (!ok && (m.mumps.infog[0] == kWorkspaceTooSmall || m.mumps.infog[0] == kIntegerWorkspaceTooSmall) &&
         m.Control(14) < kMostWorkspacePercent) {
    m.Control(14) *= 2;
    ok = m.Call(kFactor);
  }
  return {ok, m.mumps.infog[11]};
}

bool MumpsFactors::Solve(std::span<double> b) {
  Impl& m = *impl_;
  FASCICLE_CHECK(b.size() == m.order.size(), "the right-hand side has the matrix's size");
  m.mumps.rhs = b.data();
  m.mumps.nrhs = 1;
  return m.Call(kSolve);
}

}  // namespace fascicle
