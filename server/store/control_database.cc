#include "server/store/control_database.h"

#include <array>
#include <utility>

namespace fascicle::server {
namespace {

constexpr int kControlApplicationId = 0x46534343;  // "FSCC"

constexpr std::array<const char*, 3> kControlFormats = {
    // Format 1. The specification has its own table: it may be large, and an update of the job must not rewrite it.
    R"(CREATE TABLE jobs (
         id TEXT PRIMARY KEY NOT NULL,
         request_id TEXT UNIQUE,
         request_digest BLOB NOT NULL,
         scene_name TEXT NOT NULL,
         threads INTEGER NOT NULL,
         state INTEGER NOT NULL,
         failure BLOB NOT NULL,
         attempt INTEGER NOT NULL,
         generation INTEGER NOT NULL,
         create_time_us INTEGER NOT NULL,
         start_time_us INTEGER NOT NULL,
         end_time_us INTEGER NOT NULL,
         fraction REAL NOT NULL,
         time REAL NOT NULL,
         step INTEGER NOT NULL,
         frame_count INTEGER NOT NULL,
         stored_bytes INTEGER NOT NULL
       ) STRICT, WITHOUT ROWID;
       CREATE TABLE specs (
         job_id TEXT PRIMARY KEY NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
         spec BLOB NOT NULL
       ) STRICT;)",
    // Format 2.
    "ALTER TABLE jobs ADD COLUMN profile BLOB NOT NULL DEFAULT x''",
    // Format 3.
    "ALTER TABLE jobs ADD COLUMN warnings BLOB NOT NULL DEFAULT x''"};

constexpr const char* kColumns =
    "id, request_id, request_digest, scene_name, threads, state, failure, attempt, generation, create_time_us, "
    "start_time_us, end_time_us, fraction, time, step, frame_count, stored_bytes, profile, warnings";

// Reads a record from the columns above, in their order.
JobRecord ReadRecord(const Rows& row) {
  JobRecord job;
  job.id = row.String(0);
  job.request_id = row.String(1);
  job.request_digest = row.String(2);
  job.scene_name = row.String(3);
  job.threads = static_cast<int>(row.Int(4));
  job.state = static_cast<JobState>(row.Int(5));
  job.failure = row.String(6);
  job.attempt = row.Int(7);
  job.generation = row.Int(8);
  job.create_time_us = row.Int(9);
  job.start_time_us = row.Int(10);
  job.end_time_us = row.Int(11);
  job.fraction = row.Real(12);
  job.time = row.Real(13);
  job.step = row.Int(14);
  job.frame_count = row.Int(15);
  job.stored_bytes = row.Int(16);
  job.profile = row.String(17);
  job.warnings = row.String(18);
  return job;
}

// Bit s for state s, so that a set of states is a single argument of a query.
std::int64_t MaskOf(const std::vector<JobState>& states) {
  std::int64_t mask = 0;
  for (JobState state : states) mask |= std::int64_t{1} << static_cast<int>(state);
  return states.empty() ? -1 : mask;
}

}  // namespace

struct ControlDatabase::Reader {
  explicit Reader(const std::string& path) : database(path, Database::Mode::kReadOnly) {}

  Database database;
  Statement get = database.Prepare(std::string("SELECT ") + kColumns +
                                   ", (SELECT spec FROM specs WHERE job_id = id) FROM jobs WHERE id = ?");
  Statement list = database.Prepare(std::string("SELECT ") + kColumns +
                                    " FROM jobs WHERE (?1 = '' OR id < ?1) AND (?2 >> state) & 1"
                                    " ORDER BY id DESC LIMIT ?3");
  Statement has = database.Prepare("SELECT 1 FROM jobs WHERE id = ?");
  Statement ids = database.Prepare("SELECT id FROM jobs");
};

ControlDatabase::ControlDatabase(const std::string& path)
    : database_(OpenFormatted(path, kControlApplicationId, kControlFormats)),
      find_request_(database_.Prepare("SELECT id FROM jobs WHERE request_id = ?")),
      insert_job_(database_.Prepare(std::string("INSERT INTO jobs (") + kColumns +
                                    ") VALUES (?,nullif(?,''),?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)")),
      insert_spec_(database_.Prepare("INSERT INTO specs (job_id, spec) VALUES (?, ?)")),
      update_job_(database_.Prepare(
          "UPDATE jobs SET state = ?2, failure = ?3, attempt = ?4, generation = ?5, start_time_us = ?6, "
          "end_time_us = ?7, fraction = ?8, time = ?9, step = ?10, frame_count = ?11, stored_bytes = ?12, profile = "
          "?13, warnings = ?14 WHERE id = ?1")),
      delete_job_(database_.Prepare("DELETE FROM jobs WHERE id = ?")),
      writes_(database_),
      readers_([path] { return std::make_unique<Reader>(path); }) {}

ControlDatabase::~ControlDatabase() = default;

bool ControlDatabase::CreateJob(const JobRecord& job, JobRecord* existing) {
  std::string taken_by;
  writes_.Run([&] {
    taken_by.clear();
    if (!job.request_id.empty()) {
      Rows rows = find_request_.Query(job.request_id);
      if (rows.Next()) taken_by = rows.String(0);
    }
    if (!taken_by.empty()) return;
    insert_job_.Run(job.id, job.request_id, Blob{job.request_digest}, job.scene_name, job.threads,
                    static_cast<int>(job.state), Blob{job.failure}, job.attempt, job.generation, job.create_time_us,
                    job.start_time_us, job.end_time_us, job.fraction, job.time, job.step, job.frame_count,
                    job.stored_bytes, Blob{job.profile}, Blob{job.warnings});
    insert_spec_.Run(job.id, Blob{job.spec});
  });
  if (taken_by.empty()) return true;
  std::optional<JobRecord> found = GetJob(taken_by);
  if (!found) return CreateJob(job, existing);  // deleted in between, so the request id is free again
  *existing = *std::move(found);
  return false;
}

std::optional<JobRecord> ControlDatabase::GetJob(std::string_view id) {
  return readers_.With([&](Reader& reader) -> std::optional<JobRecord> {
    Rows rows = reader.get.Query(id);
    if (!rows.Next()) return std::nullopt;
    JobRecord job = ReadRecord(rows);
    job.spec = rows.String(19);
    return job;
  });
}

std::vector<JobRecord> ControlDatabase::ListJobs(int limit, std::string_view before_id,
                                                 const std::vector<JobState>& states) {
  return readers_.With([&](Reader& reader) {
    std::vector<JobRecord> jobs;
    Rows rows = reader.list.Query(before_id, MaskOf(states), limit < 0 ? 0 : limit);  // SQL: LIMIT < 0 is no limit
    while (rows.Next()) jobs.push_back(ReadRecord(rows));
    return jobs;
  });
}

void ControlDatabase::UpdateJob(const JobRecord& job) {
  writes_.Run([&] {
    update_job_.Run(job.id, static_cast<int>(job.state), Blob{job.failure}, job.attempt, job.generation,
                    job.start_time_us, job.end_time_us, job.fraction, job.time, job.step, job.frame_count,
                    job.stored_bytes, Blob{job.profile}, Blob{job.warnings});
  });
}

bool ControlDatabase::DeleteJob(std::string_view id) {
  bool deleted = false;
  writes_.Run([&] {
    delete_job_.Run(id);
    deleted = database_.changes() > 0;
  });
  return deleted;
}

bool ControlDatabase::HasJob(std::string_view id) {
  return readers_.With([&](Reader& reader) { return reader.has.Query(id).Next(); });
}

std::unordered_set<std::string> ControlDatabase::AllIds() {
  return readers_.With([](Reader& reader) {
    std::unordered_set<std::string> ids;
    Rows rows = reader.ids.Query();
    while (rows.Next()) ids.insert(rows.String(0));
    return ids;
  });
}

}  // namespace fascicle::server
