#include "server/store/control_files.h"

#include <filesystem>
#include <optional>
#include <system_error>

#include "server/store/job_tables.h"
#include "server/store/store.h"

namespace fascicle::server {
namespace {

namespace fs = std::filesystem;

Database OpenJobs(const std::string& path) { return OpenFormatted(path, kControlApplicationId, ControlFormats()); }

// What is wrong with a file; empty if nothing is, or if it does not exist.
std::string ProblemOf(const std::string& path) {
  if (!fs::exists(path)) return "";
  try {
    Database database = OpenJobs(path);
    {
      Statement check = database.Prepare("PRAGMA integrity_check(1)");  // of the indices, too
      Rows rows = check.Query();
      if (!rows.Next() || rows.Bytes(0) != "ok") return path + ": is damaged: " + rows.String(0);
    }
    const std::string damaged =
        "SELECT (SELECT count(*) FROM jobs NOT INDEXED WHERE checksum IS NOT " + JobChecksum() +
        ") + (SELECT count(*) FROM removals WHERE checksum IS NOT row_checksum(revision, job_id))";
    return database.QueryInt(damaged.c_str()) == 0 ? "" : path + ": has damaged records";
  } catch (const StoreError& error) {
    return error.what();
  }
}

// Renames a file to a name that is free, and returns that.
std::string SetAside(const std::string& path) {
  std::string aside;
  for (int n = 1; aside.empty() || fs::exists(aside); ++n) aside = path + ".damaged-" + std::to_string(n);
  std::error_code error;
  for (const char* suffix : {"-wal", "-shm", ""}) {
    if (fs::exists(path + suffix)) fs::rename(path + suffix, aside + suffix, error);
    if (error) throw StoreError(path + suffix + ": " + error.message());
  }
  return aside;
}

// Inserts all jobs of the file `from` that can be read and that `database` lacks. The others are lost; their frames
// stay in their files.
void Salvage(const std::string& from, Database& database) {
  JobWriter writer(database, "main");
  Statement has = database.Prepare("SELECT 1 FROM jobs WHERE id = ?");
  const auto salvage_job = [&](JobReader& reader, const std::string& id) {
    try {
      if (const std::optional<JobRecord> job = reader.Get(id)) writer.Insert(*job, job->revision);
    } catch (const DamageError&) {
    }
  };
  try {
    JobReader reader(from);
    for (const std::string& id : reader.Ids()) {
      if (!has.Query(id).Next()) salvage_job(reader, id);
    }
  } catch (const StoreError&) {
  }
}

// Makes control.db again from the rows of both files. Which jobs were deleted is not known any more; revisions that
// were given to later changes must not be given again.
void Rebuild(const ControlFiles& files) {
  constexpr std::int64_t kMostLost = 1'000'000;
  const std::string damaged = SetAside(files.main);
  Database database = OpenJobs(files.main);
  Transaction transaction(database);
  Salvage(damaged, database);
  Salvage(files.copy, database);
  const std::int64_t newest = database.QueryInt("SELECT ifnull(max(revision), 0) FROM jobs");
  JobWriter(database, "main").ForgetRemovals(newest + kMostLost);
  transaction.Commit();
}

// Makes the attached copy equal to control.db.
void Reconcile(Database& database) {
  database.Execute("PRAGMA foreign_keys = OFF");
  {
    Transaction transaction(database);
    database.Execute(
        "DELETE FROM copy.jobs WHERE id NOT IN (SELECT id FROM main.jobs);"
        "DELETE FROM copy.specs WHERE job_id NOT IN (SELECT id FROM main.jobs);"
        "DELETE FROM copy.removals WHERE revision NOT IN (SELECT revision FROM main.removals);"
        "REPLACE INTO copy.removals SELECT * FROM main.removals AS m WHERE checksum IS NOT "
        "(SELECT checksum FROM copy.removals AS c WHERE c.revision = m.revision);"
        "REPLACE INTO copy.jobs SELECT * FROM main.jobs AS m WHERE checksum IS NOT "
        "(SELECT checksum FROM copy.jobs AS c WHERE c.id = m.id);"
        "REPLACE INTO copy.specs SELECT * FROM main.specs AS m WHERE checksum = row_checksum(job_id, spec) AND "
        "checksum IS NOT (SELECT checksum FROM copy.specs AS c WHERE c.job_id = m.job_id)");
    transaction.Commit();
  }
  database.Execute("PRAGMA foreign_keys = ON");
}

}  // namespace

Database OpenControl(const ControlFiles& files) {
  const std::string problem = ProblemOf(files.main), problem_of_copy = ProblemOf(files.copy);
  const bool has_copy = fs::exists(files.copy);
  // A file of another kind or of a newer version is refused, unless its copy shows that it is neither.
  if (!problem.empty() && (!has_copy || !problem_of_copy.empty())) OpenJobs(files.main);
  if (!problem.empty()) Rebuild(files);
  if (!problem_of_copy.empty()) SetAside(files.copy);
  OpenJobs(files.copy);  // creates or upgrades it
  Database database = OpenJobs(files.main);
  database.Prepare("ATTACH ? AS copy").Run(files.copy);
  database.Execute("PRAGMA copy.synchronous = NORMAL; PRAGMA copy.journal_size_limit = 67108864");
  Reconcile(database);
  return database;
}

}  // namespace fascicle::server
