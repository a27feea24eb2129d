#include <algorithm>
#include <atomic>
#include <filesystem>
#include <mutex>
#include <system_error>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "server/store/asset_directory.h"
#include "server/store/control_database.h"
#include "server/store/disk_reserve.h"
#include "server/store/file_system.h"
#include "server/store/frame_database.h"
#include "server/store/store.h"

namespace fascicle::server {
namespace {

namespace fs = std::filesystem;

std::string CreateDirectories(const std::string& directory) {
  std::error_code error;
  // Only its owner may look into a directory that is created here.
  if (fs::create_directories(directory, error)) fs::permissions(directory, fs::perms::owner_all, error);
  if (!error) fs::create_directories(directory + "/jobs", error);
  if (error) throw StoreError(directory + ": " + error.message());
  SyncParent(directory + "/jobs");
  return directory;
}

std::shared_ptr<DirectoryLock> Lock(const std::string& directory) {
  CheckLocal(directory);
  return std::make_shared<DirectoryLock>(directory);
}

class SqliteStore final : public Store {
 public:
  SqliteStore(const std::string& directory, std::int64_t least_free)
      : directory_(CreateDirectories(directory)),
        lock_(Lock(directory_)),
        reserve_(directory_, least_free),
        jobs_({directory_ + "/control.db", directory_ + "/control.copy.db"}),
        assets_(directory_ + "/assets") {
    RemoveOrphans();
    RenewTransfers();
  }

  std::vector<std::optional<JobRecord>> CreateJobs(std::span<const JobRecord> jobs) override {
    if (const std::string problem = Problem(); !problem.empty()) throw NoSpaceError(problem);
    std::vector<std::optional<JobRecord>> earlier = jobs_.CreateJobs(jobs);
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      if (!earlier[i]) TakeStaged(jobs[i].id);
    }
    return earlier;
  }
  std::optional<JobRecord> GetJob(std::string_view id) override { return jobs_.GetJob(id); }
  std::optional<JobRecord> FindRequest(std::string_view request_id) override { return jobs_.FindRequest(request_id); }
  std::vector<JobRecord> ListJobs(int limit, std::string_view before_id, const std::vector<JobState>& states) override {
    return jobs_.ListJobs(limit, before_id, states);
  }
  std::vector<JobRecord> FindJobs(const JobQuery& query) override { return jobs_.FindJobs(query); }
  std::int64_t StoredBytesOf(const std::optional<std::string>& owner) override { return jobs_.StoredBytesOf(owner); }
  void UpdateJob(const JobRecord& job) override {
    WithReserve([&] { jobs_.UpdateJob(job); });
  }
  bool UpdateSettings(const JobRecord& job) override {
    bool is_there = false;
    WithReserve([&] { is_there = jobs_.UpdateSettings(job); });
    return is_there;
  }
  std::optional<JobChanges> ChangesAfter(std::int64_t revision, std::int64_t deletions_after, int limit) override {
    return jobs_.ChangesAfter(revision, deletions_after, limit);
  }
  std::int64_t Revision() override { return jobs_.Revision(); }

  bool DeleteJob(std::string_view id) override {
    const std::lock_guard lock(mutex_);
    // The row is deleted first: a file without a row is removed at the next start, whereas a row without its file would
    // be inconsistent.
    bool is_deleted = false;
    WithReserve([&] { is_deleted = jobs_.DeleteJob(id); });
    if (!is_deleted) return false;
    if (const std::shared_ptr<FrameDatabase> frames = TakeOpenFrames(id)) {
      frames->RemoveWhenClosed();
    } else {
      FrameDatabase::Remove(FramesPath(id));
    }
    return true;
  }

  bool RemoveFrames(const JobRecord& job) override {
    const std::lock_guard lock(mutex_);
    const auto open = open_frames_.find(job.id);
    if (open != open_frames_.end() && !open->second.expired()) return false;
    // The record is written in between: RemoveOrphans then knows whether to finish what was interrupted.
    WithReserve([&] { FrameDatabase::CopyInputs(FramesPath(job.id)); });
    WithReserve([&] { jobs_.UpdateJob(job); });
    FrameDatabase::KeepCopiedInputs(FramesPath(job.id));
    return true;
  }

  std::shared_ptr<FrameStore> OpenFrames(std::string_view job_id) override {
    const std::lock_guard lock(mutex_);
    std::erase_if(open_frames_, [](const auto& entry) { return entry.second.expired(); });
    const auto open = open_frames_.find(std::string(job_id));
    if (open != open_frames_.end()) {
      if (std::shared_ptr<FrameDatabase> frames = open->second.lock()) return frames;
    }
    if (!jobs_.HasJob(job_id)) return nullptr;
    auto frames = std::make_shared<FrameDatabase>(FramesPath(job_id), lock_);
    open_frames_[std::string(job_id)] = frames;
    return frames;
  }

  std::shared_ptr<FrameStore> StageFrames(std::string_view job_id) override {
    const std::lock_guard lock(mutex_);
    std::erase_if(staged_, [](const auto& entry) { return entry.second.expired(); });
    if (jobs_.HasJob(job_id) || fs::exists(FramesPath(job_id))) return nullptr;
    auto frames = std::make_shared<FrameDatabase>(FramesPath(job_id), lock_);
    frames->RemoveWhenClosed();
    staged_[std::string(job_id)] = frames;
    return frames;
  }

  std::string NewTransferPath() override { return directory_ + "/transfers/" + std::to_string(next_transfer_++); }

  bool HasAsset(std::string_view sha256_hex) override { return assets_.HasAsset(sha256_hex); }
  std::unique_ptr<Upload> BeginUpload(std::string_view sha256_hex, std::int64_t size) override {
    const std::string problem = Problem();
    if (!problem.empty()) throw NoSpaceError(problem);
    if (size > Room()) {
      throw NoSpaceError("an asset of " + std::to_string(size) + " bytes does not fit the disk");
    }
    return assets_.BeginUpload(sha256_hex, size);
  }
  std::optional<std::string> ReadAsset(std::string_view sha256_hex) override { return assets_.ReadAsset(sha256_hex); }
  std::vector<AssetRecord> ListUnusedAssets() override { return assets_.ListUnusedAssets(); }
  bool RemoveUnusedAsset(std::string_view sha256_hex) override { return assets_.RemoveUnusedAsset(sha256_hex); }

  std::int64_t Room() override { return std::max<std::int64_t>(0, reserve_.free_bytes() - reserve_.least_free()); }

  std::string Problem() override {
    if (!lock_->IsThere()) return "the data folder " + directory_ + " or its file `lock` has been removed";
    if (reserve_.HasRoom()) return "";
    return "the server's disk is almost full: " + std::to_string(reserve_.free_bytes() >> 20) + " MiB are left, " +
           std::to_string(reserve_.least_free() >> 20) + " MiB are kept free; delete jobs or other files";
  }

 private:
  // Calls `write`, and again with the reserve if the disk is full.
  template <class Write>
  void WithReserve(const Write& write) {
    try {
      write();
    } catch (const NoSpaceError&) {
      reserve_.Release();
      write();
    }
  }

  // A job is there now: its frames, if there are any, stay. Needs mutex_.
  void TakeStaged(const std::string& job_id) {
    const auto staged = staged_.find(job_id);
    if (staged == staged_.end()) return;
    if (const std::shared_ptr<FrameDatabase> frames = staged->second.lock()) {
      frames->RemoveWhenClosed(false);
      open_frames_[job_id] = frames;
    }
    staged_.erase(staged);
  }

  // The frames of a job if somebody has them open, which are then forgotten here. Needs mutex_.
  std::shared_ptr<FrameDatabase> TakeOpenFrames(std::string_view id) {
    const auto open = open_frames_.find(std::string(id));
    if (open == open_frames_.end()) return nullptr;
    std::shared_ptr<FrameDatabase> frames = open->second.lock();
    open_frames_.erase(open);
    return frames;
  }

  std::string FramesPath(std::string_view id) const { return directory_ + "/jobs/" + std::string(id) + ".db"; }

  // Removes files of jobs that are not in the control database, and finishes removals of frames, left by interruptions.
  // Keeps all of them if the control database was ever damaged: its list may be incomplete.
  void RemoveOrphans() {
    if (fs::exists(directory_ + "/control.db.damaged-1")) return;
    const std::unordered_set<std::string> ids = jobs_.Ids();
    std::vector<std::string> with_copies;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory_ + "/jobs", error)) {
      const std::string id = entry.path().stem().stem().string();
      if (!ids.contains(id)) fs::remove(entry.path(), error);
      if (ids.contains(id) && entry.path().extension() == FrameDatabase::kInputsSuffix) with_copies.push_back(id);
    }
    if (error) throw StoreError(directory_ + "/jobs: " + error.message());
    for (const std::string& id : with_copies) FinishRemoval(id);
  }

  void FinishRemoval(const std::string& id) {
    const std::optional<JobRecord> job = jobs_.GetJob(id);
    const bool is_removed = job && job->first_frame > 0 && job->first_frame == job->frame_count;
    if (is_removed) return FrameDatabase::KeepCopiedInputs(FramesPath(id));
    FrameDatabase::Remove(FramesPath(id) + FrameDatabase::kInputsSuffix);
  }

  // Removes the files of interrupted exports and imports.
  void RenewTransfers() {
    std::error_code error;
    fs::remove_all(directory_ + "/transfers", error);
    if (!error) fs::create_directory(directory_ + "/transfers", error);
    if (error) throw StoreError(directory_ + "/transfers: " + error.message());
  }

  const std::string directory_;
  const std::shared_ptr<DirectoryLock> lock_;
  DiskReserve reserve_;
  ControlDatabase jobs_;
  AssetDirectory assets_;
  std::mutex mutex_;  // guards open_frames_ and staged_; no job is deleted while its frames are being opened
  std::unordered_map<std::string, std::weak_ptr<FrameDatabase>> open_frames_;
  std::unordered_map<std::string, std::weak_ptr<FrameDatabase>> staged_;  // of jobs that are not there yet
  std::atomic<std::int64_t> next_transfer_ = 0;
};

}  // namespace

std::unique_ptr<Store> OpenSqliteStore(const std::string& directory, std::int64_t least_free) {
  return std::make_unique<SqliteStore>(directory, least_free);
}

}  // namespace fascicle::server
