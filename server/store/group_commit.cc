#include "server/store/group_commit.h"

#include <utility>

namespace fascicle::server {

void GroupCommit::Run(const std::function<void()>& write) {
  Entry own{&write, false, nullptr};
  std::unique_lock lock(mutex_);
  waiting_.push_back(&own);
  done_.wait(lock, [&] { return own.done || !committing_; });
  if (!own.done) {
    committing_ = true;
    const std::vector<Entry*> batch = std::exchange(waiting_, {});  // includes the caller's own
    lock.unlock();
    Commit(batch);
    lock.lock();
    for (Entry* entry : batch) entry->done = true;
    committing_ = false;
    done_.notify_all();
  }
  if (own.error) std::rethrow_exception(own.error);
}

void GroupCommit::Commit(const std::vector<Entry*>& batch) {
  try {
    Transaction transaction(database_);
    for (Entry* entry : batch) (*entry->write)();
    transaction.Commit();
  } catch (...) {
    if (batch.size() == 1) {
      batch.front()->error = std::current_exception();
      return;
    }
    // One failed write must not affect the others: commit each by itself.
    for (Entry* entry : batch) Commit({entry});
  }
}

}  // namespace fascicle::server
