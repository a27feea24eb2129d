#include "server/rpc/executor.h"

#include <exception>
#include <utility>

#include "server/jobs/lower_priority.h"

namespace fascicle::server {

Executor::Executor(int threads, OnError on_error, int niceness) : on_error_(std::move(on_error)) {
  for (int i = 0; i < threads; ++i) {
    threads_.emplace_back([this, niceness] {
      LowerPriority(niceness);
      Work();
    });
  }
}

Executor::~Executor() {
  {
    std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void Executor::Post(Task task) {
  {
    std::lock_guard lock(mutex_);
    ready_.push_back(std::move(task));
  }
  wake_.notify_one();
}

bool Executor::HasNoneWaiting() {
  const std::lock_guard lock(mutex_);
  return ready_.empty();
}

void Executor::PostAfter(std::chrono::milliseconds delay, Task task) {
  {
    std::lock_guard lock(mutex_);
    delayed_.emplace(Clock::now() + delay, std::move(task));
  }
  wake_.notify_one();  // some thread must be told the new earliest time
}

void Executor::Work() {
  std::unique_lock lock(mutex_);
  while (true) {
    while (!delayed_.empty() && delayed_.begin()->first <= Clock::now()) {
      ready_.push_back(std::move(delayed_.begin()->second));
      delayed_.erase(delayed_.begin());
    }
    if (!ready_.empty()) {
      if (ready_.size() > 1) wake_.notify_one();
      Task task = std::move(ready_.front());
      ready_.pop_front();
      lock.unlock();
      Run(task);
      task = nullptr;  // its captures are released outside the lock
      lock.lock();
    } else if (stopping_) {
      return;
    } else if (delayed_.empty()) {
      wake_.wait(lock);
    } else {
      wake_.wait_until(lock, Clock::time_point(delayed_.begin()->first));
    }
  }
}

void Executor::Run(const Task& task) noexcept {
  try {
    task();
  } catch (const std::exception& e) {
    on_error_(e.what());
  } catch (...) {
    on_error_("unknown exception");
  }
}

}  // namespace fascicle::server
