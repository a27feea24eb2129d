#ifndef FASCICLE_SERVER_STORE_JOB_TABLES_H_
#define FASCICLE_SERVER_STORE_JOB_TABLES_H_

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/database.h"
#include "server/store/store.h"

namespace fascicle::server {

// The tables of jobs in control.db and in its copy: their formats, and statements on them.

inline constexpr int kControlApplicationId = 0x46534343;  // "FSCC"
std::span<const char* const> ControlFormats();
// The SQL expression that `checksum` of a row of `jobs` must equal.
std::string JobChecksum();

// Writes jobs of one file of a connection: `schema` is "main" or the name of an attached file. Not thread-safe.
class JobWriter {
 public:
  JobWriter(Database& database, const std::string& schema);

  // The id of the job with this request id; empty if there is none.
  std::string FindRequest(std::string_view request_id);
  void Insert(const JobRecord& job);
  // Throws DamageError if the stored row is damaged, whose checksum would otherwise be renewed.
  void Update(const JobRecord& job);
  // False if there is no such job.
  bool Delete(std::string_view id);

 private:
  Database& database_;
  Statement find_request_, insert_job_, insert_spec_, is_intact_, update_, renew_checksum_, delete_;
};

// Reads jobs of one file over a connection of its own. Not thread-safe. Throws DamageError for damaged rows.
class JobReader {
 public:
  explicit JobReader(const std::string& path);

  std::optional<JobRecord> Get(std::string_view id);
  // As JobStore::ListJobs.
  std::vector<JobRecord> List(int limit, std::string_view before_id, const std::vector<JobState>& states);
  bool Has(std::string_view id);
  std::vector<std::string> Ids();

 private:
  Database database_;
  Statement get_, list_, has_, ids_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_JOB_TABLES_H_
