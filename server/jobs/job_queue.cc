#include "server/jobs/job_queue.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

namespace fascicle::server {
namespace {

constexpr double kHalfTime = 3600;  // [s]

double Seconds(JobQueue::Clock::duration time) { return std::chrono::duration<double>(time).count(); }

}  // namespace

bool JobQueue::Rank::operator<(const Rank& other) const {
  return std::tie(is_over_limit, priority, running, used, id) <
         std::tie(other.is_over_limit, other.priority, other.running, other.used, other.id);
}

JobQueue::Rank JobQueue::RankOf(int running, const Level& level, double used, std::string_view id) const {
  return {max_running_ > 0 && running >= max_running_, -level.first, running, used, id};
}

void JobQueue::Add(const std::string& id, const std::string& owner, int priority) {
  if (waiting_.emplace(id, Waiting{owner, priority}).second) Insert(owners_[owner], id, priority);
}

void JobQueue::Insert(Owner& owner, const std::string& id, int priority) {
  Ids& ids = owner.waiting[priority];
  ids.insert(std::lower_bound(ids.begin(), ids.end(), id), id);
  ++owner.count;
  places_.reset();
}

void JobQueue::Erase(Owner& owner, const std::string& id, int priority) {
  const auto level = owner.waiting.find(priority);
  Ids& ids = level->second;
  ids.erase(std::lower_bound(ids.begin(), ids.end(), id));
  if (ids.empty()) owner.waiting.erase(level);
  --owner.count;
  places_.reset();
}

void JobQueue::Remove(std::string_view id) {
  const auto found = waiting_.find(id);
  if (found == waiting_.end()) return;
  Erase(owners_.at(found->second.owner), found->first, found->second.priority);
  waiting_.erase(found);
}

void JobQueue::SetPriority(std::string_view id, int priority) {
  const auto found = waiting_.find(id);
  if (found == waiting_.end()) return;
  Owner& owner = owners_.at(found->second.owner);
  Erase(owner, found->first, found->second.priority);
  Insert(owner, found->first, priority);
  found->second.priority = priority;
}

double JobQueue::UsedBy(const Owner& owner, Clock::time_point now) const {
  return owner.used * std::exp2(-Seconds(now - owner.used_at) / kHalfTime);
}

std::optional<std::string> JobQueue::Take(Clock::time_point now) {
  Owner* next = nullptr;
  Rank best;
  for (auto& [name, owner] : owners_) {
    if (owner.waiting.empty()) continue;
    const Level& level = *owner.waiting.begin();
    const Rank rank = RankOf(owner.running, level, UsedBy(owner, now), level.second.front());
    if (rank.is_over_limit || (next != nullptr && !(rank < best))) continue;
    next = &owner;
    best = rank;
  }
  if (next == nullptr) return std::nullopt;
  std::string id(best.id);
  Erase(*next, id, -best.priority);
  ++next->running;
  running_[id] = {std::move(waiting_.at(id).owner), 1, now};
  waiting_.erase(id);
  return id;
}

void JobQueue::Started(const std::string& id, int threads) { running_.at(id).threads = threads; }

void JobQueue::Stopped(const std::string& id, Clock::time_point now) {
  const auto found = running_.find(id);
  if (found == running_.end()) return;
  const std::string name = found->second.owner;
  Owner& owner = owners_.at(name);
  owner.used = UsedBy(owner, now) + found->second.threads * Seconds(now - found->second.since);
  owner.used_at = now;
  --owner.running;
  running_.erase(found);
  places_.reset();
  ForgetIdleOwners(now);
}

// So that there are never many more than the owners of some hours.
void JobQueue::ForgetIdleOwners(Clock::time_point now) {
  constexpr std::size_t kManyOwners = 1000;
  constexpr double kNegligible = 0.01;  // [s]
  if (owners_.size() < kManyOwners) return;
  std::erase_if(owners_, [&](const auto& entry) {
    const Owner& owner = entry.second;
    return owner.count == 0 && owner.running == 0 && UsedBy(owner, now) < kNegligible;
  });
}

int JobQueue::CountOf(const std::string& owner) const {
  const auto found = owners_.find(owner);
  return found == owners_.end() ? 0 : found->second.count;
}

int JobQueue::threads_in_use() const {
  int threads = 0;
  for (const auto& [id, job] : running_) threads += job.threads;
  return threads;
}

int JobQueue::ThreadsOf(std::string_view id) const {
  const auto found = running_.find(id);
  return found == running_.end() ? 0 : found->second.threads;
}

int JobQueue::CountBefore(const Owner& owner, const Rank& rank, Clock::time_point now) const {
  const double used = UsedBy(owner, now);
  int count = 0;
  for (const Level& level : owner.waiting) {
    const int size = static_cast<int>(level.second.size());
    // Ranks ascend: find the first that is not smaller. Only the last digit, so to speak, needs the job's id.
    int low = 0, high = size;
    while (low < high) {
      const int middle = (low + high) / 2;
      Rank one = RankOf(owner.running + count + middle, level, used, rank.id);
      if (!(one < rank) && !(rank < one)) one.id = level.second[static_cast<std::size_t>(middle)];
      (one < rank ? low : high) = one < rank ? middle + 1 : middle;
    }
    count += low;
    if (low < size) break;
  }
  return count;
}

int JobQueue::PlaceOf(std::string_view id, Clock::time_point now) const {
  const auto found = waiting_.find(id);
  if (found == waiting_.end()) return 0;
  const Owner& own = owners_.at(found->second.owner);
  int running = own.running;
  auto level = own.waiting.begin();
  for (; level->first != found->second.priority; ++level) running += static_cast<int>(level->second.size());
  const Ids& ids = level->second;
  running += static_cast<int>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
  const Rank rank = RankOf(running, *level, UsedBy(own, now), id);
  int place = 0;
  for (const auto& [name, owner] : owners_) place += CountBefore(owner, rank, now);
  return place;
}

std::shared_ptr<const JobQueue::Places> JobQueue::PlacesOfAll(Clock::time_point now) {
  if (places_ != nullptr) return places_;
  std::vector<Rank> ranks;
  ranks.reserve(waiting_.size());
  for (const auto& [name, owner] : owners_) {
    const double used = UsedBy(owner, now);
    int running = owner.running;
    for (const Level& level : owner.waiting) {
      for (const std::string& id : level.second) ranks.push_back(RankOf(running++, level, used, id));
    }
  }
  std::sort(ranks.begin(), ranks.end());
  auto places = std::make_shared<Places>(ranks.size());
  for (const Rank& rank : ranks) places->emplace(rank.id, static_cast<int>(places->size()));
  places_ = std::move(places);
  return places_;
}

}  // namespace fascicle::server
