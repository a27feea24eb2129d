#ifndef FASCICLE_SERVER_JOBS_JOB_QUEUE_H_
#define FASCICLE_SERVER_JOBS_JOB_QUEUE_H_

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace fascicle::server {

// The jobs that wait, and which of them is next: of those with the highest priority, one of the owner with the fewest
// running jobs; of several such owners, of the one whose jobs used the least processor time (threads times wall time in
// this process, halved every hour); of that owner's, the oldest. Not thread-safe.
class JobQueue {
 public:
  using Clock = std::chrono::steady_clock;

  // `max_running`: most running jobs of an owner; 0: no limit.
  explicit JobQueue(int max_running = 0) : max_running_(max_running) {}

  void Add(const std::string& id, const std::string& owner, int priority);
  // Nothing happens if it does not wait.
  void Remove(std::string_view id);
  void SetPriority(std::string_view id, int priority);

  // The next job, which waits no longer; nothing if none may be started.
  std::optional<std::string> Take(Clock::time_point now);
  // A job that was taken has a number of threads, or needs its worker no longer.
  void Started(const std::string& id, int threads);
  void Stopped(const std::string& id, Clock::time_point now);

  bool Contains(std::string_view id) const { return waiting_.contains(id); }
  int size() const { return static_cast<int>(waiting_.size()); }
  int CountOf(const std::string& owner) const;
  int running() const { return static_cast<int>(running_.size()); }
  int threads_in_use() const;
  int ThreadsOf(std::string_view id) const;  // 0 if it does not run

  // How many jobs would be started before this one if all were started one after another and none ended; 0 if it does
  // not wait.
  int PlaceOf(std::string_view id, Clock::time_point now) const;
  // The same of all waiting jobs; computed again only when the queue has changed.
  using Places = std::unordered_map<std::string, int>;
  std::shared_ptr<const Places> PlacesOfAll(Clock::time_point now);

 private:
  struct Waiting {
    std::string owner;
    int priority = 0;
  };
  struct Running {
    std::string owner;
    int threads = 1;
    Clock::time_point since;
  };
  // Of waiting jobs, ascending, which is the order of creation. Most are added at the end and taken from the beginning,
  // and their places are counted: all without visiting the others.
  using Ids = std::deque<std::string>;
  struct Owner {
    std::map<int, Ids, std::greater<>> waiting;  // by descending priority
    int count = 0;                               // of waiting jobs
    int running = 0;
    double used = 0;  // processor time at `used_at` [s]
    Clock::time_point used_at;
  };

  // Jobs of an owner with the same priority.
  using Level = std::pair<const int, Ids>;

  // The smallest is started first. Ranks of an owner's jobs ascend in the order in which they are started.
  struct Rank {
    bool is_over_limit = false;
    int priority = 0;  // negative
    int running = 0;   // jobs of its owner when it is started
    double used = 0;
    std::string_view id;
    bool operator<(const Rank& other) const;
  };

  double UsedBy(const Owner& owner, Clock::time_point now) const;
  // Of a job that is started when its owner has `running` others.
  Rank RankOf(int running, const Level& level, double used, std::string_view id) const;
  // How many jobs of an owner have a smaller rank.
  int CountBefore(const Owner& owner, const Rank& rank, Clock::time_point now) const;
  void Insert(Owner& owner, const std::string& id, int priority);
  void Erase(Owner& owner, const std::string& id, int priority);
  void ForgetIdleOwners(Clock::time_point now);

  const int max_running_;
  std::map<std::string, Waiting, std::less<>> waiting_;
  std::map<std::string, Running, std::less<>> running_;
  std::map<std::string, Owner, std::less<>> owners_;
  std::shared_ptr<const Places> places_;  // null: unknown
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_JOBS_JOB_QUEUE_H_
