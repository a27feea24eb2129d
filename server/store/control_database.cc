#include "server/store/control_database.h"

#include <memory>
#include <utility>

namespace fascicle::server {

ControlDatabase::ControlDatabase(const ControlFiles& files)
    : database_(OpenControl(files)),
      main_(database_, "main"),
      copy_(database_, "copy"),
      writes_(database_),
      readers_([path = files.main] { return std::make_unique<JobReader>(path); }),
      copy_readers_([path = files.copy] { return std::make_unique<JobReader>(path); }) {}

template <class Read>
auto ControlDatabase::ReadWith(const Read& read) {
  try {
    return readers_.With(read);
  } catch (const DamageError&) {
    return copy_readers_.With(read);
  }
}

bool ControlDatabase::CreateJob(const JobRecord& job, JobRecord* existing) {
  std::string taken_by;
  writes_.Run([&] {
    taken_by.clear();
    if (!job.request_id.empty()) taken_by = main_.FindRequest(job.request_id);
    if (!taken_by.empty()) return;
    main_.Insert(job);
    copy_.Insert(job);
  });
  if (taken_by.empty()) return true;
  std::optional<JobRecord> found = GetJob(taken_by);
  if (!found) return CreateJob(job, existing);  // deleted in between, so the request id is free again
  *existing = *std::move(found);
  return false;
}

std::optional<JobRecord> ControlDatabase::GetJob(std::string_view id) {
  return ReadWith([&](JobReader& reader) { return reader.Get(id); });
}

std::vector<JobRecord> ControlDatabase::ListJobs(int limit, std::string_view before_id,
                                                 const std::vector<JobState>& states) {
  return ReadWith([&](JobReader& reader) { return reader.List(limit, before_id, states); });
}

void ControlDatabase::UpdateJob(const JobRecord& job) {
  writes_.Run([&] {
    main_.Update(job);
    copy_.Update(job);
  });
}

bool ControlDatabase::DeleteJob(std::string_view id) {
  bool deleted = false;
  writes_.Run([&] {
    deleted = main_.Delete(id);
    copy_.Delete(id);
  });
  return deleted;
}

bool ControlDatabase::HasJob(std::string_view id) {
  return ReadWith([&](JobReader& reader) { return reader.Has(id); });
}

std::unordered_set<std::string> ControlDatabase::AllIds() {
  return ReadWith([](JobReader& reader) {
    const std::vector<std::string> ids = reader.Ids();
    return std::unordered_set<std::string>(ids.begin(), ids.end());
  });
}

}  // namespace fascicle::server
