#include "core/linalg/direct_solver.h"

#include <mutex>
#include <new>
#include <utility>
#include <vector>

#include "core/base/check.h"
#include "core/linalg/elimination_order.h"
#include "core/linalg/mumps_factors.h"
#include "core/linalg/solver_process.h"

namespace fascicle {
namespace {

// Calls for larger systems take so long that others must not wait for them.
constexpr std::int32_t kMostInThisProcess = 6000;

}  // namespace

struct DirectSolver::Impl {
  std::stop_token stop;
  std::size_t unknowns = 0, entries = 0;
  // One of them, after Analyze.
  std::unique_ptr<SolverProcess> process;
  std::unique_ptr<MumpsFactors> factors;
};

DirectSolver::DirectSolver(std::stop_token stop) : impl_(std::make_unique<Impl>()) { impl_->stop = std::move(stop); }

DirectSolver::~DirectSolver() {
  if (impl_->factors == nullptr) return;
  const std::lock_guard lock(MumpsMutex());
  impl_->factors.reset();
}

bool DirectSolver::Analyze(std::int32_t size, std::span<const std::int32_t> rows,
                           std::span<const std::int32_t> columns) {
  Impl& d = *impl_;
  d.unknowns = static_cast<std::size_t>(size);
  d.entries = rows.size();
  const std::vector<std::int32_t> order = EliminationOrder(size, rows, columns);
  if (order.empty()) return false;
  if (size > kMostInThisProcess) d.process = SolverProcess::Start(order, rows, columns);
  if (d.process != nullptr) return d.process->Analyze(d.stop);
  const std::lock_guard lock(MumpsMutex());
  if (d.factors == nullptr) d.factors = std::make_unique<MumpsFactors>();
  return d.factors->Analyze(order, rows, columns);
}

DirectSolver::Factored DirectSolver::Factor(std::span<const double> values) {
  Impl& d = *impl_;
  FASCICLE_CHECK(values.size() == d.entries, "one value for each entry of the pattern");
  if (d.process != nullptr) return d.process->Factor(values, d.stop);
  const std::lock_guard lock(MumpsMutex());
  return d.factors->Factor(values);
}

void DirectSolver::Solve(std::span<double> b) {
  Impl& d = *impl_;
  FASCICLE_CHECK(b.size() == d.unknowns, "the right-hand side has the matrix's size");
  if (d.process != nullptr) {
    // Factors solve, unless their process was ended.
    if (!d.process->Solve(b, d.stop)) throw std::bad_alloc();
    return;
  }
  const std::lock_guard lock(MumpsMutex());
  FASCICLE_CHECK(d.factors->Solve(b), "a factored matrix solves");
}

}  // namespace fascicle
