#include "server/store/job_tables.h"

#include <array>

namespace fascicle::server {
namespace {

constexpr std::array<const char*, 4> kControlFormats = {
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
    "ALTER TABLE jobs ADD COLUMN warnings BLOB NOT NULL DEFAULT x''",
    // Format 4: crashes and checksums.
    R"(ALTER TABLE jobs ADD COLUMN crash_score INTEGER NOT NULL DEFAULT 0;
       ALTER TABLE jobs ADD COLUMN crash_place INTEGER NOT NULL DEFAULT -1;
       ALTER TABLE jobs ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
       UPDATE jobs SET checksum = row_checksum(id, request_id, request_digest, scene_name, threads, state, failure,
         attempt, generation, create_time_us, start_time_us, end_time_us, fraction, time, step, frame_count,
         stored_bytes, profile, warnings, crash_score, crash_place);
       ALTER TABLE specs ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
       UPDATE specs SET checksum = row_checksum(job_id, spec);)"};

constexpr std::string_view kColumns =
    "id, request_id, request_digest, scene_name, threads, state, failure, attempt, generation, create_time_us, "
    "start_time_us, end_time_us, fraction, time, step, frame_count, stored_bytes, profile, warnings, "
    "crash_score, crash_place";

std::string Columns() { return std::string(kColumns); }
// The columns of a record, and whether they are intact.
std::string CheckedColumns() { return Columns() + ", " + JobChecksum() + " = jobs.checksum"; }
constexpr int kIntact = 21, kSpec = 22, kSpecIntact = 23;

// Reads a record from CheckedColumns().
JobRecord ReadRecord(const Rows& row, const Database& database) {
  if (row.Int(kIntact) != 1) {
    throw DamageError(database.path() + ": the record of job " + row.String(0) + " is damaged");
  }
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
  job.crash_score = row.Int(19);
  job.crash_place = row.Int(20);
  return job;
}

// Bit s for state s, so that a set of states is a single argument of a query.
std::int64_t MaskOf(const std::vector<JobState>& states) {
  std::int64_t mask = 0;
  for (JobState state : states) mask |= std::int64_t{1} << static_cast<int>(state);
  return states.empty() ? -1 : mask;
}

}  // namespace

std::span<const char* const> ControlFormats() { return kControlFormats; }

std::string JobChecksum() { return "row_checksum(" + Columns() + ")"; }

JobWriter::JobWriter(Database& database, const std::string& schema)
    : database_(database),
      find_request_(database.Prepare("SELECT id FROM " + schema + ".jobs WHERE request_id = ?")),
      insert_job_(database.Prepare("INSERT INTO " + schema + ".jobs (" + Columns() +
                                   ") VALUES (?,nullif(?,''),?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)")),
      insert_spec_(database.Prepare("INSERT INTO " + schema +
                                    ".specs (job_id, spec, checksum) VALUES (?1, ?2, row_checksum(?1, ?2))")),
      is_intact_(database.Prepare("SELECT " + JobChecksum() + " = checksum FROM " + schema + ".jobs WHERE id = ?")),
      update_(database.Prepare(
          "UPDATE " + schema +
          ".jobs SET state = ?2, failure = ?3, attempt = ?4, generation = ?5, start_time_us = ?6, end_time_us = ?7, "
          "fraction = ?8, time = ?9, step = ?10, frame_count = ?11, stored_bytes = ?12, profile = ?13, warnings = ?14, "
          "crash_score = ?15, crash_place = ?16 WHERE id = ?1")),
      renew_checksum_(database.Prepare("UPDATE " + schema + ".jobs SET checksum = " + JobChecksum() + " WHERE id = ?")),
      delete_(database.Prepare("DELETE FROM " + schema + ".jobs WHERE id = ?")) {}

std::string JobWriter::FindRequest(std::string_view request_id) {
  Rows rows = find_request_.Query(request_id);
  return rows.Next() ? rows.String(0) : std::string();
}

void JobWriter::Insert(const JobRecord& job) {
  insert_job_.Run(job.id, job.request_id, Blob{job.request_digest}, job.scene_name, job.threads,
                  static_cast<int>(job.state), Blob{job.failure}, job.attempt, job.generation, job.create_time_us,
                  job.start_time_us, job.end_time_us, job.fraction, job.time, job.step, job.frame_count,
                  job.stored_bytes, Blob{job.profile}, Blob{job.warnings}, job.crash_score, job.crash_place);
  renew_checksum_.Run(job.id);
  insert_spec_.Run(job.id, Blob{job.spec});
}

void JobWriter::Update(const JobRecord& job) {
  {
    Rows rows = is_intact_.Query(job.id);
    if (!rows.Next()) return;
    if (rows.Int(0) != 1) throw DamageError(database_.path() + ": the record of job " + job.id + " is damaged");
  }
  update_.Run(job.id, static_cast<int>(job.state), Blob{job.failure}, job.attempt, job.generation, job.start_time_us,
              job.end_time_us, job.fraction, job.time, job.step, job.frame_count, job.stored_bytes, Blob{job.profile},
              Blob{job.warnings}, job.crash_score, job.crash_place);
  renew_checksum_.Run(job.id);
}

bool JobWriter::Delete(std::string_view id) {
  delete_.Run(id);
  return database_.changes() > 0;
}

JobReader::JobReader(const std::string& path)
    : database_(path, Database::Mode::kReadOnly),
      get_(database_.Prepare("SELECT " + CheckedColumns() +
                             ", spec, row_checksum(job_id, spec) = specs.checksum "
                             "FROM jobs LEFT JOIN specs ON job_id = id WHERE id = ?")),
      list_(database_.Prepare("SELECT " + CheckedColumns() +
                              " FROM jobs WHERE (?1 = '' OR id < ?1) AND (?2 >> state) & 1 ORDER BY id DESC LIMIT ?3")),
      has_(database_.Prepare("SELECT 1 FROM jobs WHERE id = ?")),
      ids_(database_.Prepare("SELECT id FROM jobs")) {}

std::optional<JobRecord> JobReader::Get(std::string_view id) {
  Rows rows = get_.Query(id);
  if (!rows.Next()) return std::nullopt;
  JobRecord job = ReadRecord(rows, database_);
  if (rows.Int(kSpecIntact) != 1) throw DamageError(database_.path() + ": the scene of job " + job.id + " is damaged");
  job.spec = rows.String(kSpec);
  return job;
}

std::vector<JobRecord> JobReader::List(int limit, std::string_view before_id, const std::vector<JobState>& states) {
  std::vector<JobRecord> jobs;
  Rows rows = list_.Query(before_id, MaskOf(states), limit < 0 ? 0 : limit);  // SQL: LIMIT < 0 is no limit
  while (rows.Next()) jobs.push_back(ReadRecord(rows, database_));
  return jobs;
}

bool JobReader::Has(std::string_view id) { return has_.Query(id).Next(); }

std::vector<std::string> JobReader::Ids() {
  std::vector<std::string> ids;
  Rows rows = ids_.Query();
  while (rows.Next()) ids.push_back(rows.String(0));
  return ids;
}

}  // namespace fascicle::server
