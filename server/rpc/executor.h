#ifndef FASCICLE_SERVER_RPC_EXECUTOR_H_
#define FASCICLE_SERVER_RPC_EXECUTOR_H_

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace fascicle::server {

// Threads for everything that may block (disk, locks, translation of scenes). gRPC has only as many threads as the
// machine has cores; a reaction that blocks one of them delays every call of the server. Thread-safe.
class Executor {
 public:
  using Task = std::function<void()>;
  using OnError = std::function<void(const std::string& what)>;

  // `on_error` receives exceptions that escape from a task; it must not throw. `niceness` is that of the threads,
  // beyond that of the process.
  Executor(int threads, OnError on_error, int niceness = 0);
  // Runs the tasks posted without delay, drops delayed ones, and joins the threads.
  ~Executor();
  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;

  void Post(Task task);
  // Whether no task waits for a thread.
  bool HasNoneWaiting();
  void PostAfter(std::chrono::milliseconds delay, Task task);

 private:
  using Clock = std::chrono::steady_clock;

  void Work();
  void Run(const Task& task) noexcept;

  const OnError on_error_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Task> ready_;
  std::multimap<Clock::time_point, Task> delayed_;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_EXECUTOR_H_
