#ifndef FASCICLE_TESTS_FAULTS_FAILING_STORE_H_
#define FASCICLE_TESTS_FAULTS_FAILING_STORE_H_

#include <atomic>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/store/store.h"

namespace fascicle::server {

// Counts the calls of a store and makes a range of them fail. Thread-safe.
class Faults {
 public:
  static constexpr int kForEver = std::numeric_limits<int>::max();

  // Calls first, first + 1, ... fail, `count` of them; `first` counts from 0, from now on.
  void FailFrom(int first, int count = kForEver) {
    calls_ = 0;
    count_ = count;
    first_ = first;
  }
  void Heal() { first_ = kForEver; }
  int calls() const { return calls_; }

  void Call() {
    const int call = calls_++;
    if (call >= first_ && call - first_ < count_) throw StoreError("disk full, so the test wants it");
  }

 private:
  std::atomic<int> calls_ = 0;
  std::atomic<int> first_ = kForEver;
  std::atomic<int> count_ = kForEver;
};

// A store that fails on request and otherwise forwards to another one. A failed call has no effect.
class FailingStore final : public Store {
 public:
  struct Points {
    Faults reads;         // of jobs and frames
    Faults job_writes;    // CreateJobs, UpdateJob, DeleteJob
    Faults frame_writes;  // PutFrame, PutGeometry, PutSteering, PutLog
  };

  explicit FailingStore(std::unique_ptr<Store> behind) : behind_(std::move(behind)) {}

  Points& faults() { return *faults_; }

  std::vector<std::optional<JobRecord>> CreateJobs(std::span<const JobRecord> jobs) override {
    faults_->job_writes.Call();
    return behind_->CreateJobs(jobs);
  }
  std::optional<JobRecord> GetJob(std::string_view id) override {
    faults_->reads.Call();
    return behind_->GetJob(id);
  }
  std::optional<JobRecord> FindRequest(std::string_view request_id) override {
    faults_->reads.Call();
    return behind_->FindRequest(request_id);
  }
  std::vector<JobRecord> ListJobs(int limit, std::string_view before_id, const std::vector<JobState>& states) override {
    faults_->reads.Call();
    return behind_->ListJobs(limit, before_id, states);
  }
  std::vector<JobRecord> FindJobs(const JobQuery& query) override {
    faults_->reads.Call();
    return behind_->FindJobs(query);
  }
  std::int64_t StoredBytesOf(const std::optional<std::string>& owner) override {
    faults_->reads.Call();
    return behind_->StoredBytesOf(owner);
  }
  void UpdateJob(const JobRecord& job) override {
    faults_->job_writes.Call();
    behind_->UpdateJob(job);
  }
  bool UpdateSettings(const JobRecord& job) override {
    faults_->job_writes.Call();
    return behind_->UpdateSettings(job);
  }
  std::optional<JobChanges> ChangesAfter(std::int64_t revision, std::int64_t deletions_after, int limit) override {
    faults_->reads.Call();
    return behind_->ChangesAfter(revision, deletions_after, limit);
  }
  std::int64_t Revision() override { return behind_->Revision(); }
  bool RemoveFrames(const JobRecord& job) override {
    faults_->job_writes.Call();
    return behind_->RemoveFrames(job);
  }
  std::vector<AssetRecord> ListUnusedAssets() override { return behind_->ListUnusedAssets(); }
  bool RemoveUnusedAsset(std::string_view sha256_hex) override { return behind_->RemoveUnusedAsset(sha256_hex); }
  bool DeleteJob(std::string_view id) override {
    faults_->job_writes.Call();
    return behind_->DeleteJob(id);
  }
  std::string Problem() override { return behind_->Problem(); }
  std::int64_t Room() override { return behind_->Room(); }
  std::shared_ptr<FrameStore> OpenFrames(std::string_view job_id) override {
    faults_->reads.Call();
    std::shared_ptr<FrameStore> frames = behind_->OpenFrames(job_id);
    return frames == nullptr ? nullptr : std::make_shared<Frames>(std::move(frames), faults_);
  }
  std::shared_ptr<FrameStore> StageFrames(std::string_view job_id) override { return behind_->StageFrames(job_id); }
  std::string NewTransferPath() override { return behind_->NewTransferPath(); }
  bool HasAsset(std::string_view sha256_hex) override { return behind_->HasAsset(sha256_hex); }
  std::unique_ptr<Upload> BeginUpload(std::string_view sha256_hex, std::int64_t size) override {
    return behind_->BeginUpload(sha256_hex, size);
  }
  std::optional<std::string> ReadAsset(std::string_view sha256_hex) override { return behind_->ReadAsset(sha256_hex); }

 private:
  class Frames final : public FrameStore {
   public:
    Frames(std::shared_ptr<FrameStore> behind, std::shared_ptr<Points> faults)
        : behind_(std::move(behind)), faults_(std::move(faults)) {}

    void PutGeometry(std::string_view bytes) override {
      faults_->frame_writes.Call();
      behind_->PutGeometry(bytes);
    }
    std::optional<std::int64_t> GeometrySize() override {
      faults_->reads.Call();
      return behind_->GeometrySize();
    }
    std::optional<std::string> ReadGeometryChunk(std::int64_t chunk) override {
      faults_->reads.Call();
      return behind_->ReadGeometryChunk(chunk);
    }
    bool PutFrame(const FrameRecord& frame, std::string_view bytes, std::string_view checkpoint,
                  std::span<const LogRow> log) override {
      faults_->frame_writes.Call();
      return behind_->PutFrame(frame, bytes, checkpoint, log);
    }
    void DropCheckpoints() override {
      faults_->frame_writes.Call();
      behind_->DropCheckpoints();
    }
    std::optional<CheckpointRecord> GetCheckpoint(std::int64_t frame) override {
      faults_->reads.Call();
      return behind_->GetCheckpoint(frame);
    }
    std::vector<FrameRecord> ListFrames(std::int64_t start, int limit) override {
      faults_->reads.Call();
      return behind_->ListFrames(start, limit);
    }
    std::int64_t replacements() override { return behind_->replacements(); }
    std::int64_t frame_count() override { return behind_->frame_count(); }
    std::int64_t stored_bytes() override { return behind_->stored_bytes(); }
    std::optional<std::string> ReadChunk(std::int64_t index, std::int64_t chunk) override {
      faults_->reads.Call();
      return behind_->ReadChunk(index, chunk);
    }
    void PutLog(std::span<const LogRow> lines) override {
      faults_->frame_writes.Call();
      behind_->PutLog(lines);
    }
    std::vector<LogRow> ReadLog(std::int64_t start, int limit) override {
      faults_->reads.Call();
      return behind_->ReadLog(start, limit);
    }
    std::int64_t log_end() override { return behind_->log_end(); }
    void PutSteering(const SteeringRecord& record) override {
      faults_->frame_writes.Call();
      behind_->PutSteering(record);
    }
    std::vector<SteeringRecord> ListSteering(std::int64_t start, int limit) override {
      faults_->reads.Call();
      return behind_->ListSteering(start, limit);
    }

   private:
    const std::shared_ptr<FrameStore> behind_;
    const std::shared_ptr<Points> faults_;
  };

  const std::unique_ptr<Store> behind_;
  const std::shared_ptr<Points> faults_ = std::make_shared<Points>();
};

}  // namespace fascicle::server

#endif  // FASCICLE_TESTS_FAULTS_FAILING_STORE_H_
