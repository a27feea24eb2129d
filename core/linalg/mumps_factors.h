#ifndef FASCICLE_CORE_LINALG_MUMPS_FACTORS_H_
#define FASCICLE_CORE_LINALG_MUMPS_FACTORS_H_

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>

#include "core/linalg/direct_solver.h"

namespace fascicle {

// To be held during the calls below, and while another process is made: MUMPS has global state.
std::mutex& MumpsMutex();

// MUMPS's analysis and factors of one matrix, as those of a DirectSolver.
class MumpsFactors {
 public:
  MumpsFactors();
  ~MumpsFactors();
  MumpsFactors(const MumpsFactors&) = delete;
  MumpsFactors& operator=(const MumpsFactors&) = delete;

  // order[i]: the place of unknown i in the elimination. False if memory runs out.
  bool Analyze(std::span<const std::int32_t> order, std::span<const std::int32_t> rows,
               std::span<const std::int32_t> columns);
  DirectSolver::Factored Factor(std::span<const double> values);
  bool Solve(std::span<double> b);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_MUMPS_FACTORS_H_
