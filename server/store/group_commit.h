#ifndef FASCICLE_SERVER_STORE_GROUP_COMMIT_H_
#define FASCICLE_SERVER_STORE_GROUP_COMMIT_H_

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <vector>

#include "server/store/database.h"

namespace fascicle::server {

// Lets concurrent writers share a transaction and its fsync. The first writer commits at once; those that arrive
// meanwhile are committed together by one of them. Thread-safe.
class GroupCommit {
 public:
  explicit GroupCommit(Database& database) : database_(database) {}

  // Runs `write` within a transaction and returns when it is durable. An exception of `write` is rethrown here, and its
  // changes are rolled back. `write` may run more than once; only the last run counts.
  void Run(const std::function<void()>& write);

 private:
  struct Entry {
    const std::function<void()>* write;
    bool done = false;
    std::exception_ptr error;
  };

  void Commit(const std::vector<Entry*>& batch);

  Database& database_;
  std::mutex mutex_;
  std::condition_variable done_;
  std::vector<Entry*> waiting_;
  bool committing_ = false;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_GROUP_COMMIT_H_
