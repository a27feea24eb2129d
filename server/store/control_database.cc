#include "server/store/control_database.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace fascicle::server {
namespace {

constexpr std::size_t kKeptRemovals = 10'000;

std::deque<std::int64_t> RemovalsOf(Database& database) {
  std::deque<std::int64_t> revisions;
  Statement statement = database.Prepare("SELECT revision FROM removals WHERE job_id <> '' ORDER BY revision");
  Rows rows = statement.Query();
  while (rows.Next()) revisions.push_back(rows.Int(0));
  return revisions;
}

constexpr const char* kNewestRevision =
    "SELECT max((SELECT ifnull(max(revision), 0) FROM jobs), (SELECT ifnull(max(revision), 0) FROM removals))";
constexpr const char* kForgotten = "SELECT ifnull(max(revision), 0) FROM removals WHERE job_id = ''";

}  // namespace

ControlDatabase::ControlDatabase(const ControlFiles& files)
    : database_(OpenControl(files)),
      main_(database_, "main"),
      copy_(database_, "copy"),
      writes_(database_),
      readers_([path = files.main] { return std::make_unique<JobReader>(path); }),
      copy_readers_([path = files.copy] { return std::make_unique<JobReader>(path); }),
      next_revision_(database_.QueryInt(kNewestRevision) + 1),
      revision_(next_revision_ - 1),
      forgotten_(database_.QueryInt(kForgotten)),
      removals_(RemovalsOf(database_)) {}

template <class Read>
auto ControlDatabase::ReadWith(const Read& read) {
  try {
    return readers_.With(read);
  } catch (const DamageError&) {
    return copy_readers_.With(read);
  }
}

template <class Write>
void ControlDatabase::Change(const Write& write, std::size_t count) {
  std::int64_t own = 0;
  writes_.Run([&] {
    const std::int64_t first = next_revision_;
    next_revision_ += static_cast<std::int64_t>(count);
    own = next_revision_ - 1;
    write(first);
  });
  // Revisions are given in the order of the commits: all below this one are durable, too.
  std::int64_t newest = revision_;
  while (newest < own && !revision_.compare_exchange_weak(newest, own)) {
  }
}

std::vector<std::optional<JobRecord>> ControlDatabase::FindEarlier(std::span<const JobRecord> jobs) {
  std::vector<std::optional<JobRecord>> earlier;
  for (const JobRecord& job : jobs) {
    earlier.push_back(FindRequest(job.request_id));
    if (!earlier.back() || earlier.back()->request_digest == job.request_digest) continue;
    throw RequestReusedError(job.request_id, earlier.back()->id);
  }
  return earlier;
}

std::vector<std::optional<JobRecord>> ControlDatabase::CreateJobs(std::span<const JobRecord> jobs) {
  std::vector<std::optional<JobRecord>> earlier;
  // Whether within the commit the same jobs are there that were found before it.
  const auto are_still_there = [&] {
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      const std::string& request = jobs[i].request_id;
      if (!request.empty() && main_.FindRequest(request) != (earlier[i] ? earlier[i]->id : "")) return false;
    }
    return true;
  };
  bool is_done = false;
  const auto insert = [&](std::int64_t revision) {
    is_done = are_still_there();
    for (std::size_t i = 0; i < jobs.size() && is_done; ++i, ++revision) {
      if (earlier[i]) continue;
      main_.Insert(jobs[i], revision);
      copy_.Insert(jobs[i], revision);
    }
  };
  // Again if one of them was created or deleted in between. Damaged ids would never agree.
  constexpr int kMostAttempts = 100;
  for (int attempt = 0; attempt < kMostAttempts && !is_done; ++attempt) {
    earlier = FindEarlier(jobs);
    Change(insert, jobs.size());
  }
  if (!is_done) throw DamageError(database_.path() + ": the record of an earlier job is damaged");
  return earlier;
}

std::optional<JobRecord> ControlDatabase::GetJob(std::string_view id) {
  return ReadWith([&](JobReader& reader) { return reader.Get(id); });
}

std::optional<JobRecord> ControlDatabase::FindRequest(std::string_view request_id) {
  return ReadWith([&](JobReader& reader) { return reader.FindRequest(request_id); });
}

std::vector<JobRecord> ControlDatabase::ListJobs(int limit, std::string_view before_id,
                                                 const std::vector<JobState>& states) {
  return ReadWith([&](JobReader& reader) { return reader.List(limit, before_id, states); });
}

std::vector<JobRecord> ControlDatabase::FindJobs(const JobQuery& query) {
  return ReadWith([&](JobReader& reader) { return reader.Find(query); });
}

std::int64_t ControlDatabase::StoredBytesOf(const std::optional<std::string>& owner) {
  return ReadWith([&](JobReader& reader) { return reader.StoredBytesOf(owner); });
}

void ControlDatabase::UpdateJob(const JobRecord& job) {
  Change([&](std::int64_t revision) {
    main_.Update(job, revision);
    copy_.Update(job, revision);
  });
}

bool ControlDatabase::UpdateSettings(const JobRecord& job) {
  bool is_there = false;
  Change([&](std::int64_t revision) {
    is_there = main_.UpdateSettings(job, revision);
    copy_.UpdateSettings(job, revision);
  });
  return is_there;
}

bool ControlDatabase::DeleteJob(std::string_view id) {
  bool is_deleted = false;
  std::int64_t removal = 0;
  Change([&](std::int64_t revision) {
    removal = revision;
    is_deleted = main_.Delete(id, revision);
    copy_.Delete(id, revision);
  });
  if (is_deleted) NoteRemoval(removal);
  return is_deleted;
}

void ControlDatabase::NoteRemoval(std::int64_t revision) {
  {
    const std::lock_guard lock(removals_mutex_);
    removals_.push_back(revision);
    if (removals_.size() < 2 * kKeptRemovals) return;
    const auto kept = removals_.end() - kKeptRemovals;
    forgotten_ = *(kept - 1);
    removals_.erase(removals_.begin(), kept);
  }
  writes_.Run([&, last = forgotten_.load()] {
    main_.ForgetRemovals(last);
    copy_.ForgetRemovals(last);
  });
}

std::optional<JobChanges> ControlDatabase::ChangesAfter(std::int64_t revision, std::int64_t deletions_after,
                                                        int limit) {
  const std::int64_t last = revision_;
  deletions_after = std::max(revision, deletions_after);
  if (revision > last) return std::nullopt;
  JobChanges changes = ReadWith([&](JobReader& reader) {
    return reader.Changes({.after = revision, .deletions_after = deletions_after, .last = last, .limit = limit});
  });
  // Looked at afterwards: what was not forgotten then was there before.
  if (deletions_after < forgotten_) return std::nullopt;
  return changes;
}

bool ControlDatabase::HasJob(std::string_view id) {
  return ReadWith([&](JobReader& reader) { return reader.Has(id); });
}

std::unordered_set<std::string> ControlDatabase::Ids() {
  return ReadWith([](JobReader& reader) {
    const std::vector<std::string> ids = reader.Ids();
    return std::unordered_set<std::string>(ids.begin(), ids.end());
  });
}

}  // namespace fascicle::server
