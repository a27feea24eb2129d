#include "cholmod_solver.h"

#include <cholmod.h>

#include "core/base/check.h"

namespace fascicle::bench {

struct CholmodSolver::Impl {
  explicit Impl(const CondensedMatrix& m) : matrix(m) {
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
    common.print = 0;
    sparse.nrow = sparse.ncol = matrix.size();
    sparse.nzmax = matrix.values().size();
    sparse.stype = -1;
    sparse.itype = CHOLMOD_INT;
    sparse.xtype = CHOLMOD_REAL;
    sparse.dtype = CHOLMOD_DOUBLE;
    sparse.sorted = sparse.packed = 1;
    sparse.p = const_cast<std::int32_t*>(matrix.column_begin().data());
    sparse.i = const_cast<std::int32_t*>(matrix.rows().data());
    sparse.x = const_cast<double*>(matrix.values().data());
  }
  ~Impl() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }

  const CondensedMatrix& matrix;
  cholmod_common common;
  cholmod_sparse sparse = {};
  cholmod_factor* factor = nullptr;
};

CholmodSolver::CholmodSolver(const CondensedMatrix& matrix) : impl_(std::make_unique<Impl>(matrix)) {
  impl_->factor = cholmod_analyze(&impl_->sparse, &impl_->common);
  FASCICLE_CHECK(impl_->factor != nullptr, "memory for the analysis");
}

CholmodSolver::~CholmodSolver() = default;

bool CholmodSolver::Factor() {
  cholmod_factorize(&impl_->sparse, impl_->factor, &impl_->common);
  return impl_->common.status == CHOLMOD_OK;
}

std::vector<double> CholmodSolver::Solve(const std::vector<double>& right_side) {
  cholmod_dense b = {};
  b.nrow = b.nzmax = b.d = right_side.size();
  b.ncol = 1;
  b.x = const_cast<double*>(right_side.data());
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* x = cholmod_solve(CHOLMOD_A, impl_->factor, &b, &impl_->common);
  FASCICLE_CHECK(x != nullptr, "a factored matrix solves");
  const auto* const values = static_cast<const double*>(x->x);
  std::vector<double> solution(values, values + right_side.size());
  cholmod_free_dense(&x, &impl_->common);
  return solution;
}

double CholmodSolver::entries() const { return impl_->common.lnz; }
double CholmodSolver::operations() const { return impl_->common.fl; }

}  // namespace fascicle::bench
