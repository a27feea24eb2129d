#include "core/linalg/solver_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <mutex>
#include <utility>

#include "core/base/stop.h"
#include "core/linalg/mumps_factors.h"

namespace fascicle {
namespace {

constexpr char kToAnalyze = 'a', kToFactor = 'f', kToSolve = 's';
constexpr int kLookForStop = 20;  // [ms]

// The first lines of the other process. It must not keep anything of this one open (a listening socket, say), nor run
// its handlers of signals; a request to end this process is no request to end a factorization. It ends with the thread
// that started it.
void BecomeSolver(int socket, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(0);
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL}) std::signal(signal, SIG_DFL);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(signal, SIG_IGN);
  close_range(3, static_cast<unsigned>(socket) - 1, 0);
  close_range(static_cast<unsigned>(socket) + 1, ~0U, 0);
  // The first to go when memory runs out.
  const int score = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (score >= 0) {
    (void)!write(score, "900", 3);
    close(score);
  }
}

}  // namespace

// Memory that both processes see.
struct SolverProcess::Shared {
  Shared(std::size_t entries, std::size_t unknowns) : size((entries + unknowns + 1) * sizeof(double)) {
    memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) return;
    auto* const numbers = static_cast<double*>(memory);
    values = {numbers, entries};
    side = {numbers + entries, unknowns};
    negative_pivots = reinterpret_cast<std::int32_t*>(numbers + entries + unknowns);
  }
  ~Shared() {
    if (memory != MAP_FAILED) munmap(memory, size);
  }
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;

  const std::size_t size;
  void* memory;
  std::span<double> values, side;
  std::int32_t* negative_pivots = nullptr;
};

std::unique_ptr<SolverProcess> SolverProcess::Start(std::span<const std::int32_t> order,
                                                    std::span<const std::int32_t> rows,
                                                    std::span<const std::int32_t> columns) {
  auto shared = std::make_unique<Shared>(rows.size(), order.size());
  std::array<int, 2> sockets;
  if (shared->memory == MAP_FAILED || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0) {
    return nullptr;
  }
  const pid_t parent = getpid();
  std::unique_lock lock(MumpsMutex());  // the copy of the library is at rest
  const pid_t process = fork();
  if (process == 0) {
    BecomeSolver(sockets[1], parent);
    MumpsFactors factors;
    for (char request = 0; read(sockets[1], &request, 1) == 1;) {
      DirectSolver::Factored factored;
      char ok = 0;
      if (request == kToAnalyze) ok = factors.Analyze(order, rows, columns);
      if (request == kToSolve) ok = factors.Solve(shared->side);
      if (request == kToFactor) {
        factored = factors.Factor(shared->values);
        ok = factored.ok;
        *shared->negative_pivots = factored.negative_pivots;
      }
      if (write(sockets[1], &ok, 1) != 1) break;
    }
    _exit(0);
  }
  lock.unlock();
  close(sockets[1]);
  if (process > 0) return std::unique_ptr<SolverProcess>(new SolverProcess(process, sockets[0], std::move(shared)));
  close(sockets[0]);
  return nullptr;
}

SolverProcess::SolverProcess(pid_t process, int socket, std::unique_ptr<Shared> shared)
    : process_(process), socket_(socket), shared_(std::move(shared)) {}

SolverProcess::~SolverProcess() {
  End();
  close(socket_);
}

void SolverProcess::End() {
  if (process_ < 0) return;
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
  process_ = -1;
}

bool SolverProcess::Ask(char request, const std::stop_token& stop) {
  if (process_ < 0) return false;
  if (send(socket_, &request, 1, MSG_NOSIGNAL) != 1) {
    End();
    return false;
  }
  pollfd answer = {socket_, POLLIN, 0};
  while (poll(&answer, 1, kLookForStop) <= 0) {
    if (!stop.stop_requested()) continue;
    End();
    throw Stopped();
  }
  char ok = 0;
  if (read(socket_, &ok, 1) != 1) End();
  return ok != 0;
}

bool SolverProcess::Analyze(const std::stop_token& stop) { return Ask(kToAnalyze, stop); }

DirectSolver::Factored SolverProcess::Factor(std::span<const double> values, const std::stop_token& stop) {
  std::copy(values.begin(), values.end(), shared_->values.begin());
  if (!Ask(kToFactor, stop)) return {};
  return {true, *shared_->negative_pivots};
}

bool SolverProcess::Solve(std::span<double> b, const std::stop_token& stop) {
  std::copy(b.begin(), b.end(), shared_->side.begin());
  if (!Ask(kToSolve, stop)) return false;
  std::copy(shared_->side.begin(), shared_->side.end(), b.begin());
  return true;
}

}  // namespace fascicle
