#ifndef FASCICLE_SERVER_STORE_CONTROL_DATABASE_H_
#define FASCICLE_SERVER_STORE_CONTROL_DATABASE_H_

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <span>
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

  std::vector<std::optional<JobRecord>> CreateJobs(std::span<const JobRecord> jobs) override;
  std::optional<JobRecord> GetJob(std::string_view id) override;
  std::optional<JobRecord> FindRequest(std::string_view request_id) override;
  std::vector<JobRecord> ListJobs(int limit, std::string_view before_id, const std::vector<JobState>& states) override;
  std::vector<JobRecord> FindJobs(const JobQuery& query) override;
  std::int64_t StoredBytesOf(const std::optional<std::string>& owner) override;
  void UpdateJob(const JobRecord& job) override;
  bool UpdateSettings(const JobRecord& job) override;
  bool DeleteJob(std::string_view id) override;
  std::optional<JobChanges> ChangesAfter(std::int64_t revision, std::int64_t deletions_after, int limit) override;
  std::int64_t Revision() override { return revision_; }

  bool HasJob(std::string_view id);
  std::unordered_set<std::string> Ids();

 private:
  // Calls read(reader) for control.db or, if that is damaged, for the copy.
  template <class Read>
  auto ReadWith(const Read& read);
  // Makes changes of `count` jobs durable: write(revision), with the number of the first of these changes.
  template <class Write>
  void Change(const Write& write, std::size_t count = 1);
  // The earlier jobs with the request ids of `jobs`; nothing for those that are new. Throws RequestReusedError.
  std::vector<std::optional<JobRecord>> FindEarlier(std::span<const JobRecord> jobs);
  // Forgets old ones if there are too many.
  void NoteRemoval(std::int64_t revision);

  Database database_;
  JobWriter main_, copy_;
  GroupCommit writes_;
  ReaderPool<JobReader> readers_, copy_readers_;
  std::int64_t next_revision_;           // of the thread that commits
  std::atomic<std::int64_t> revision_;   // of the last durable change
  std::atomic<std::int64_t> forgotten_;  // deletions up to this revision are not known
  std::mutex removals_mutex_;            // guards removals_
  std::deque<std::int64_t> removals_;    // revisions of the known deletions
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_CONTROL_DATABASE_H_
