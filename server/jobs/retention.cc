#include "server/jobs/retention.h"

#include <exception>
#include <set>
#include <utility>

#include "server/jobs/active_job.h"

namespace fascicle::server {
namespace {

constexpr int kPage = 200;

std::vector<JobCondition> AnyOf(const std::vector<JobState>& states) {
  std::vector<JobCondition> conditions;
  for (const JobState state : states) {
    conditions.push_back({.field = JobField::kState, .number = static_cast<int>(state)});
  }
  return conditions;
}

}  // namespace

Retention::Retention(Store& store, const JobCodec& codec, const JobManagerOptions& options, Actions actions)
    : store_(store),
      codec_(codec),
      options_(options),
      actions_(std::move(actions)),
      thread_([this](const std::stop_token& stop) { Work(stop); }) {}

Retention::~Retention() {
  thread_.request_stop();
  thread_.join();
}

template <class Action>
void Retention::Try(const Action& action) {
  try {
    action();
  } catch (const std::exception& error) {
    if (std::exchange(last_error_, error.what()) != error.what()) {
      options_.on_note(std::string("what need not be kept can't be removed: ") + error.what());
    }
  }
}

void Retention::Work(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    Try([&] { DeleteExpired(stop); });
    Try([&] { KeepBudget(stop); });
    Try([&] { RemoveUnusedAssets(stop); });
    std::unique_lock lock(mutex_);
    stopped_.wait_for(lock, stop, options_.retention_interval, [] { return false; });
  }
}

std::vector<JobRecord> Retention::Finished(const std::vector<JobCondition>& conditions) {
  JobQuery query = {.order = JobField::kEnded, .is_descending = false, .limit = kPage};
  query.filter.groups = {AnyOf({JobState::kSucceeded, JobState::kFailed, JobState::kCancelled}),
                         {{.field = JobField::kPinned, .number = 0}}};
  for (const JobCondition& condition : conditions) query.filter.groups.push_back({condition});
  return store_.FindJobs(query);
}

void Retention::DeleteExpired(const std::stop_token& stop) {
  using Relation = JobCondition::Relation;
  const std::int64_t now = UnixTimeUs();
  std::vector<JobRecord> expired = Finished({{.field = JobField::kExpiry, .relation = Relation::kLess, .number = now}});
  if (options_.default_ttl_s > 0) {
    const std::int64_t ended_before = now - 1'000'000 * options_.default_ttl_s;
    for (JobRecord& job :
         Finished({{.field = JobField::kTtl, .number = 0},
                   {.field = JobField::kEnded, .relation = Relation::kLess, .number = ended_before}})) {
      expired.push_back(std::move(job));
    }
  }
  for (const JobRecord& job : expired) {
    if (stop.stop_requested()) return;
    Try([&] { actions_.delete_job(job); });
  }
}

void Retention::KeepBudget(const std::stop_token& stop) {
  if (options_.disk_budget <= 0) return;
  std::int64_t excess = store_.StoredBytesOf(std::nullopt) - options_.disk_budget;
  if (excess <= 0) return;
  for (const JobRecord& job :
       Finished({{.field = JobField::kStoredBytes, .relation = JobCondition::Relation::kGreater, .number = 0}})) {
    if (excess <= 0 || stop.stop_requested()) return;
    Try([&] { excess -= actions_.remove_frames(job) ? job.stored_bytes : 0; });
  }
}

void Retention::RemoveUnusedAssets(const std::stop_token& stop) {
  constexpr std::chrono::minutes kInterval(30);
  const auto now = std::chrono::steady_clock::now();
  if (now < next_assets_ || !codec_.assets_of) return;
  next_assets_ = now + kInterval;
  const std::vector<AssetRecord> unused = store_.ListUnusedAssets();
  if (unused.empty()) return;
  std::set<std::string> needed;
  std::string before;
  // A job that can't be read keeps everything: what it needs is not known.
  while (true) {
    const std::vector<JobRecord> page = store_.ListJobs(kPage, before, {});
    if (page.empty()) break;
    before = page.back().id;
    for (const JobRecord& listed : page) {
      if (stop.stop_requested()) return;
      const std::optional<JobRecord> job = store_.GetJob(listed.id);
      if (job) needed.merge(codec_.assets_of(job->spec));
    }
  }
  for (const AssetRecord& asset : unused) {
    if (needed.contains(asset.sha256_hex)) continue;
    if (!store_.RemoveUnusedAsset(asset.sha256_hex)) continue;
    options_.on_note("removed asset " + asset.sha256_hex + ", " + std::to_string(asset.size) +
                     " bytes: no job names it");
  }
}

}  // namespace fascicle::server
