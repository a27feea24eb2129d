#ifndef FASCICLE_SERVER_STORE_CONTROL_DATABASE_H_
#define FASCICLE_SERVER_STORE_CONTROL_DATABASE_H_

#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "server/store/database.h"
#include "server/store/group_commit.h"
#include "server/store/reader_pool.h"
#include "server/store/store.h"

namespace fascicle::server {

// The jobs, in control.db. Thread-safe.
class ControlDatabase final : public JobStore {
 public:
  explicit ControlDatabase(const std::string& path);
  ~ControlDatabase() override;

  bool CreateJob(const JobRecord& job, JobRecord* existing) override;
  std::optional<JobRecord> GetJob(std::string_view id) override;
  std::vector<JobRecord> ListJobs(int limit, std::string_view before_id, const std::vector<JobState>& states) override;
  void UpdateJob(const JobRecord& job) override;
  bool DeleteJob(std::string_view id) override;

  bool HasJob(std::string_view id);
  std::unordered_set<std::string> AllIds();

 private:
  struct Reader;

  Database database_;
  Statement find_request_;
  Statement insert_job_;
  Statement insert_spec_;
  Statement update_job_;
  Statement delete_job_;
  GroupCommit writes_;
  ReaderPool<Reader> readers_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_CONTROL_DATABASE_H_
