#ifndef FASCICLE_SERVER_STORE_CONTROL_DATABASE_H_
#define FASCICLE_SERVER_STORE_CONTROL_DATABASE_H_

#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "server/store/control_files.h"
#include "server/store/database.h"
#include "server/store/group_commit.h"
#include "server/store/job_tables.h"
#include "server/store/reader_pool.h"
#include "server/store/store.h"

namespace fascicle::server {

// The jobs, in control.db and its copy (control_files.h). A row that is damaged in control.db is read from the copy.
// Thread-safe.
class ControlDatabase final : public JobStore {
 public:
  explicit ControlDatabase(const ControlFiles& files);

  bool CreateJob(const JobRecord& job, JobRecord* existing) override;
  std::optional<JobRecord> GetJob(std::string_view id) override;
  std::vector<JobRecord> ListJobs(int limit, std::string_view before_id, const std::vector<JobState>& states) override;
  void UpdateJob(const JobRecord& job) override;
  bool DeleteJob(std::string_view id) override;

  bool HasJob(std::string_view id);
  std::unordered_set<std::string> AllIds();

 private:
  // Calls read(reader) for control.db or, if that is damaged, for the copy.
  template <class Read>
  auto ReadWith(const Read& read);

  Database database_;
  JobWriter main_, copy_;
  GroupCommit writes_;
  ReaderPool<JobReader> readers_, copy_readers_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_CONTROL_DATABASE_H_
