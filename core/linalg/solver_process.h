#ifndef FASCICLE_CORE_LINALG_SOLVER_PROCESS_H_
#define FASCICLE_CORE_LINALG_SOLVER_PROCESS_H_

#include <sys/types.h>

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>

#include "core/linalg/direct_solver.h"

namespace fascicle {

// MumpsFactors in a process of its own: no other solver waits for it, a stop request ends it at once, and when memory
// runs out, the system ends it rather than this process. Calls wait for the other process and throw Stopped after a
// stop request; that, and its unexpected end, end it for good. Not thread-safe.
class SolverProcess {
 public:
  // A process that knows a pattern, with `order` as in MumpsFactors::Analyze; null if none can be made.
  static std::unique_ptr<SolverProcess> Start(std::span<const std::int32_t> order, std::span<const std::int32_t> rows,
                                              std::span<const std::int32_t> columns);
  ~SolverProcess();
  SolverProcess(const SolverProcess&) = delete;
  SolverProcess& operator=(const SolverProcess&) = delete;

  // As those of DirectSolver; false also if the process has ended.
  bool Analyze(const std::stop_token& stop);
  DirectSolver::Factored Factor(std::span<const double> values, const std::stop_token& stop);
  bool Solve(std::span<double> b, const std::stop_token& stop);

 private:
  struct Shared;

  SolverProcess(pid_t process, int socket, std::unique_ptr<Shared> shared);
  // Has the other process do something. False if it could not, or has ended.
  bool Ask(char request, const std::stop_token& stop);
  void End();

  pid_t process_;  // -1 once it has ended
  const int socket_;
  const std::unique_ptr<Shared> shared_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_LINALG_SOLVER_PROCESS_H_
