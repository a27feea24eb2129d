#include "server/jobs/job_queue.h"

#include <cmath>
#include <tuple>
#include <utility>

namespace fascicle::server {
namespace {

constexpr double kHalfTime = 3600;  // [s]

double Seconds(JobQueue::Clock::duration time) { return std::chrono::duration<double>(time).count(); }

}  // namespace

bool JobQueue::Rank::operator<(const Rank& other) const {
  return std::tie(priority, running, used, oldest) < std::tie(other.priority, other.running, other.used, other.oldest);
}

void JobQueue::Add(const std::string& id, const std::string& owner, int priority) {
  if (!waiting_.emplace(id, Waiting{owner, priority}).second) return;
  Owner& of = owners_[owner];
  of.waiting[priority].insert(id);
  ++of.count;
  has_places_ = false;
}

void JobQueue::Erase(Owner& owner, const std::string& id, int priority) {
  const auto same = owner.waiting.find(priority);
  same->second.erase(id);
  if (same->second.empty()) owner.waiting.erase(same);
  --owner.count;
  has_places_ = false;
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
  owner.waiting[priority].insert(found->first);
  ++owner.count;
  found->second.priority = priority;
}

double JobQueue::UsedBy(const Owner& owner, Clock::time_point now) const {
  return owner.used * std::exp2(-Seconds(now - owner.used_at) / kHalfTime);
}

std::optional<std::string> JobQueue::Take(Clock::time_point now) {
  Owner* next = nullptr;
  Rank best;
  for (auto& [name, owner] : owners_) {
    if (owner.waiting.empty() || (max_running_ > 0 && owner.running >= max_running_)) continue;
    const auto& [priority, ids] = *owner.waiting.begin();
    const Rank rank = {-priority, owner.running, UsedBy(owner, now), *ids.begin()};
    if (next != nullptr && !(rank < best)) continue;
    next = &owner;
    best = rank;
  }
  if (next == nullptr) return std::nullopt;
  std::string id(best.oldest);
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
  has_places_ = false;
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

int JobQueue::PlaceOf(std::string_view id, Clock::time_point now) {
  if (!waiting_.contains(id)) return 0;
  if (!has_places_) FindPlaces(now);
  return places_.at(std::string(id));
}

// Owners at their limit come last.
void JobQueue::FindPlaces(Clock::time_point now) {
  places_.clear();
  struct Turn {
    bool is_at_limit = false;
    Rank rank;
    Owner* owner = nullptr;
    std::map<int, std::set<std::string>, std::greater<>>::const_iterator level;
    std::set<std::string>::const_iterator id;
    double used = 0;
    int running = 0;
    bool operator<(const Turn& other) const {
      return std::tie(is_at_limit, rank) < std::tie(other.is_at_limit, other.rank);
    }
  };
  const auto turn_of = [&](Turn turn) {
    turn.is_at_limit = max_running_ > 0 && turn.running >= max_running_;
    turn.rank = {-turn.level->first, turn.running, turn.used, *turn.id};
    return turn;
  };
  std::multiset<Turn> turns;
  for (auto& [name, owner] : owners_) {
    if (owner.waiting.empty()) continue;
    const auto level = owner.waiting.cbegin();
    turns.insert(turn_of({.is_at_limit = false,
                          .rank = {},
                          .owner = &owner,
                          .level = level,
                          .id = level->second.cbegin(),
                          .used = UsedBy(owner, now),
                          .running = owner.running}));
  }
  for (int place = 0; !turns.empty(); ++place) {
    Turn turn = *turns.begin();
    turns.erase(turns.begin());
    places_.emplace_hint(places_.end(), *turn.id, place);
    ++turn.running;
    if (++turn.id == turn.level->second.cend()) {
      if (++turn.level == turn.owner->waiting.cend()) continue;
      turn.id = turn.level->second.cbegin();
    }
    turns.insert(turn_of(std::move(turn)));
  }
  has_places_ = true;
}

}  // namespace fascicle::server
