#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <shared_mutex>
#include <stdexcept>
#include <utility>

#include "core/base/digest.h"
#include "server/store/store.h"

namespace fascicle::server {
namespace {

class MemoryFrameStore final : public FrameStore {
 public:
  void PutGeometry(std::string_view bytes) override {
    const std::unique_lock lock(mutex_);
    stored_bytes_ +=
        static_cast<std::int64_t>(bytes.size()) - (geometry_ ? static_cast<std::int64_t>(geometry_->size()) : 0);
    geometry_ = bytes;
  }

  std::optional<std::int64_t> GeometrySize() override {
    const std::shared_lock lock(mutex_);
    if (!geometry_) return std::nullopt;
    return static_cast<std::int64_t>(geometry_->size());
  }

  std::optional<std::string> ReadGeometryChunk(std::int64_t chunk) override {
    const std::shared_lock lock(mutex_);
    if (!geometry_) return std::nullopt;
    return ChunkOf(*geometry_, chunk);
  }

  using FrameStore::PutFrame;
  bool PutFrame(const FrameRecord& frame, std::string_view bytes, std::string_view checkpoint,
                std::span<const LogRow> log) override {
    const std::unique_lock lock(mutex_);
    const auto count = static_cast<std::int64_t>(frames_.size());
    if (frame.index < 0 || frame.index > count) {
      throw std::invalid_argument("frame " + std::to_string(frame.index) + " does not follow the stored ones");
    }
    const bool is_there = frame.index < count;
    const bool is_same = is_there && frames_[static_cast<std::size_t>(frame.index)].record.digest == frame.digest;
    if (!is_same) {
      DropFramesFrom(static_cast<std::size_t>(frame.index));
      frames_.push_back({frame, std::string(bytes)});
      frames_.back().record.size = static_cast<std::int64_t>(bytes.size());
      stored_bytes_ += frames_.back().record.size;
    }
    if (!checkpoint.empty()) {
      checkpoints_[frame.index] = checkpoint;
      while (checkpoints_.size() > 2) checkpoints_.erase(checkpoints_.begin());
    }
    AddLines(log);
    const bool is_replaced = is_there && !is_same;
    if (is_replaced) ++replacements_;
    return is_replaced;
  }

  std::int64_t replacements() override {
    const std::shared_lock lock(mutex_);
    return replacements_;
  }

  void DropCheckpoints() override {
    const std::unique_lock lock(mutex_);
    checkpoints_.clear();
  }

  std::optional<CheckpointRecord> GetCheckpoint(std::int64_t frame) override {
    const std::shared_lock lock(mutex_);
    auto found = checkpoints_.lower_bound(frame);
    if (found == checkpoints_.begin()) return std::nullopt;
    --found;
    return CheckpointRecord{found->first, found->second};
  }

  std::vector<FrameRecord> ListFrames(std::int64_t start, int limit) override {
    const std::shared_lock lock(mutex_);
    std::vector<FrameRecord> records;
    for (auto i = static_cast<std::size_t>(std::max<std::int64_t>(start, 0)); i < frames_.size(); ++i) {
      if (static_cast<int>(records.size()) >= limit) break;
      records.push_back(frames_[i].record);
    }
    return records;
  }

  std::int64_t frame_count() override {
    const std::shared_lock lock(mutex_);
    return static_cast<std::int64_t>(frames_.size());
  }

  std::int64_t stored_bytes() override {
    const std::shared_lock lock(mutex_);
    return stored_bytes_;
  }

  std::optional<std::string> ReadChunk(std::int64_t index, std::int64_t chunk) override {
    const std::shared_lock lock(mutex_);
    if (index < 0 || index >= static_cast<std::int64_t>(frames_.size())) return std::nullopt;
    return ChunkOf(frames_[static_cast<std::size_t>(index)].bytes, chunk);
  }

  void PutLog(std::span<const LogRow> lines) override {
    const std::unique_lock lock(mutex_);
    AddLines(lines);
  }

  std::vector<LogRow> ReadLog(std::int64_t start, int limit) override {
    const std::shared_lock lock(mutex_);
    std::vector<LogRow> lines;
    for (auto line = log_.lower_bound(start); line != log_.end() && static_cast<int>(lines.size()) < limit; ++line) {
      lines.push_back({line->first, line->second});
    }
    return lines;
  }

  std::int64_t log_end() override {
    const std::shared_lock lock(mutex_);
    return LogEnd();
  }

  void PutSteering(const SteeringRecord& record) override {
    const std::unique_lock lock(mutex_);
    steering_[record.sequence] = record;
  }

  std::vector<SteeringRecord> ListSteering(std::int64_t start, int limit) override {
    const std::shared_lock lock(mutex_);
    std::vector<SteeringRecord> records;
    for (auto input = steering_.lower_bound(start); input != steering_.end(); ++input) {
      if (static_cast<int>(records.size()) >= limit) break;
      records.push_back(input->second);
    }
    return records;
  }

 private:
  struct StoredFrame {
    FrameRecord record;
    std::string bytes;
  };

  // Empty data has one empty chunk.
  static std::optional<std::string> ChunkOf(const std::string& bytes, std::int64_t chunk) {
    const auto last = std::max<std::int64_t>(static_cast<std::int64_t>(bytes.size()) - 1, 0) / kChunkSize;
    if (chunk < 0 || chunk > last) return std::nullopt;
    return bytes.substr(static_cast<std::size_t>(chunk * kChunkSize), static_cast<std::size_t>(kChunkSize));
  }

  void DropFramesFrom(std::size_t index) {
    for (std::size_t i = index; i < frames_.size(); ++i) stored_bytes_ -= frames_[i].record.size;
    frames_.resize(std::min(index, frames_.size()));
    checkpoints_.erase(checkpoints_.lower_bound(static_cast<std::int64_t>(index)), checkpoints_.end());
  }

  std::int64_t LogEnd() const { return log_.empty() ? 0 : log_.rbegin()->first + 1; }

  void AddLines(std::span<const LogRow> lines) {
    for (const LogRow& row : lines) {
      if (row.number >= kFirstLines && row.number < LogEnd() - kLastLines) continue;
      const auto stored = log_.find(row.number);
      if (stored != log_.end() && stored->second == row.bytes) continue;
      log_.erase(log_.lower_bound(row.number), log_.end());
      log_.emplace(row.number, row.bytes);
      log_.erase(log_.lower_bound(kFirstLines), log_.lower_bound(std::max(kFirstLines, LogEnd() - kLastLines)));
    }
  }

  std::shared_mutex mutex_;
  std::map<std::int64_t, std::string> log_;
  std::map<std::int64_t, SteeringRecord> steering_;
  std::optional<std::string> geometry_;
  std::vector<StoredFrame> frames_;
  std::map<std::int64_t, std::string> checkpoints_;
  std::int64_t replacements_ = 0;
  std::int64_t stored_bytes_ = 0;
};

class MemoryStore final : public Store {
 public:
  std::vector<std::optional<JobRecord>> CreateJobs(std::span<const JobRecord> jobs) override {
    const std::unique_lock lock(mutex_);
    std::vector<std::optional<JobRecord>> earlier;
    for (const JobRecord& job : jobs) earlier.push_back(FindEarlier(job));
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      if (!earlier[i]) Create(jobs[i]);
    }
    return earlier;
  }

  std::optional<JobRecord> GetJob(std::string_view id) override {
    const std::shared_lock lock(mutex_);
    const auto found = jobs_.find(id);
    if (found == jobs_.end()) return std::nullopt;
    return found->second.record;
  }

  std::optional<JobRecord> FindRequest(std::string_view request_id) override {
    const std::shared_lock lock(mutex_);
    const auto found = ids_by_request_.find(request_id);
    if (found == ids_by_request_.end()) return std::nullopt;
    return jobs_.at(found->second).record;
  }

  std::vector<JobRecord> ListJobs(int limit, std::string_view before_id, const std::vector<JobState>& states) override {
    const std::shared_lock lock(mutex_);
    std::vector<JobRecord> records;
    auto end = before_id.empty() ? jobs_.end() : jobs_.lower_bound(before_id);
    while (end != jobs_.begin() && static_cast<int>(records.size()) < limit) {
      const JobRecord& record = (--end)->second.record;
      if (!states.empty() && std::find(states.begin(), states.end(), record.state) == states.end()) continue;
      records.push_back(record);
      records.back().spec.clear();
    }
    return records;
  }

  std::vector<JobRecord> FindJobs(const JobQuery& query) override {
    const std::shared_lock lock(mutex_);
    std::vector<JobRecord> records;
    for (const auto& [id, job] : jobs_) {
      const bool is_later = !query.after || IsBefore(query, *query.after, PlaceOf(job.record, query.order));
      if (is_later && query.filter.Passes(job.record)) records.push_back(job.record);
    }
    std::sort(records.begin(), records.end(), [&](const JobRecord& a, const JobRecord& b) {
      return IsBefore(query, PlaceOf(a, query.order), PlaceOf(b, query.order));
    });
    records.resize(std::min(records.size(), static_cast<std::size_t>(std::max(query.limit, 0))));
    for (JobRecord& record : records) record.spec.clear();
    return records;
  }

  std::int64_t StoredBytesOf(const std::optional<std::string>& owner) override {
    const std::shared_lock lock(mutex_);
    std::int64_t bytes = 0;
    for (const auto& [id, job] : jobs_) bytes += !owner || job.record.owner == *owner ? job.record.stored_bytes : 0;
    return bytes;
  }

  void UpdateJob(const JobRecord& job) override {
    const std::unique_lock lock(mutex_);
    const auto found = jobs_.find(job.id);
    if (found != jobs_.end()) Update(job, found->second.record);
  }

  bool UpdateSettings(const JobRecord& job) override {
    const std::unique_lock lock(mutex_);
    const auto found = jobs_.find(job.id);
    if (found == jobs_.end()) return false;
    JobRecord& record = found->second.record;
    record.labels = job.labels;
    record.priority = job.priority;
    record.ttl_s = job.ttl_s;
    record.is_pinned = job.is_pinned;
    record.revision = ++revision_;
    return true;
  }

  std::optional<JobChanges> ChangesAfter(std::int64_t revision, std::int64_t deletions_after, int limit) override {
    const std::shared_lock lock(mutex_);
    if (revision > revision_) return std::nullopt;
    std::map<std::int64_t, const JobRecord*> changed;
    for (const auto& [id, job] : jobs_) {
      if (job.record.revision > revision) changed[job.record.revision] = &job.record;
    }
    JobChanges changes;
    changes.revision = revision_;
    for (const auto& [number, record] : changed) {
      changes.changed.push_back(*record);
      changes.changed.back().spec.clear();
      if (static_cast<int>(changes.changed.size()) < limit) continue;
      changes.revision = number;
      break;
    }
    const auto first = deletions_.upper_bound(std::max(revision, deletions_after));
    for (auto deletion = first; deletion != deletions_.upper_bound(changes.revision); ++deletion) {
      changes.deleted.push_back(deletion->second);
    }
    return changes;
  }

  std::int64_t Revision() override {
    const std::shared_lock lock(mutex_);
    return revision_;
  }

  bool DeleteJob(std::string_view id) override {
    const std::unique_lock lock(mutex_);
    const auto found = jobs_.find(id);
    if (found == jobs_.end()) return false;
    ids_by_request_.erase(found->second.record.request_id);
    jobs_.erase(found);
    deletions_[++revision_] = id;
    return true;
  }

  std::string Problem() override { return ""; }
  std::int64_t Room() override { return std::numeric_limits<std::int64_t>::max(); }

  std::shared_ptr<FrameStore> OpenFrames(std::string_view job_id) override {
    const std::shared_lock lock(mutex_);
    const auto found = jobs_.find(job_id);
    return found == jobs_.end() ? nullptr : found->second.frames;
  }

  std::shared_ptr<FrameStore> StageFrames(std::string_view job_id) override {
    const std::unique_lock lock(mutex_);
    std::erase_if(staged_, [](const auto& entry) { return entry.second.expired(); });
    if (jobs_.contains(job_id) || staged_.contains(job_id)) return nullptr;
    auto frames = std::make_shared<MemoryFrameStore>();
    staged_.emplace(job_id, frames);
    return frames;
  }

  std::string NewTransferPath() override {
    const std::unique_lock lock(mutex_);
    if (!transfers_) transfers_.emplace();
    return transfers_->path + "/" + std::to_string(next_transfer_++);
  }

  bool RemoveFrames(const JobRecord& job) override {
    const std::unique_lock lock(mutex_);
    const auto found = jobs_.find(job.id);
    if (found == jobs_.end() || found->second.frames.use_count() > 1) return false;
    Update(job, found->second.record);
    auto kept = std::make_shared<MemoryFrameStore>();
    for (const SteeringRecord& input : found->second.frames->ListSteering(0, std::numeric_limits<int>::max())) {
      kept->PutSteering(input);
    }
    found->second.frames = std::move(kept);
    return true;
  }

  bool HasAsset(std::string_view sha256_hex) override {
    const std::shared_lock lock(mutex_);
    return assets_.contains(sha256_hex);
  }

  std::unique_ptr<Upload> BeginUpload(std::string_view sha256_hex, std::int64_t size) override {
    return std::make_unique<MemoryUpload>(*this, sha256_hex, size);
  }

  std::optional<std::string> ReadAsset(std::string_view sha256_hex) override {
    const std::shared_lock lock(mutex_);
    const auto found = assets_.find(sha256_hex);
    if (found == assets_.end()) return std::nullopt;
    return found->second;
  }

  // Its assets are as old as the process.
  std::vector<AssetRecord> ListUnusedAssets() override { return {}; }

  bool RemoveUnusedAsset(std::string_view) override { return false; }

 private:
  struct StoredJob {
    JobRecord record;
    std::shared_ptr<MemoryFrameStore> frames = std::make_shared<MemoryFrameStore>();
  };

  // The job that was created earlier for the same request. Needs mutex_.
  std::optional<JobRecord> FindEarlier(const JobRecord& job) const {
    const auto taken = ids_by_request_.find(job.request_id);
    if (taken == ids_by_request_.end()) return std::nullopt;
    const JobRecord& record = jobs_.at(taken->second).record;
    if (record.request_digest != job.request_digest) throw RequestReusedError(job.request_id, record.id);
    return record;
  }

  // Needs mutex_.
  void Create(const JobRecord& job) {
    if (!job.request_id.empty()) ids_by_request_[job.request_id] = job.id;
    StoredJob& stored = jobs_[job.id];
    stored.record = job;
    if (const auto staged = staged_.find(job.id); staged != staged_.end()) {
      if (auto frames = staged->second.lock()) stored.frames = std::move(frames);
      staged_.erase(staged);
    }
    stored.record.revision = ++revision_;
  }

  // A temporary folder of its own.
  struct Transfers {
    Transfers() : path((std::filesystem::temp_directory_path() / "fascicle-XXXXXX").string()) {
      if (mkdtemp(path.data()) == nullptr) throw StoreError("can't make a temporary folder " + path);
    }
    ~Transfers() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
    std::string path;
  };
  // Needs mutex_. What UpdateJob does not write stays as it was.
  void Update(const JobRecord& job, JobRecord& record) {
    JobRecord updated = job;
    updated.owner = std::move(record.owner);
    updated.labels = std::move(record.labels);
    updated.priority = record.priority;
    updated.ttl_s = record.ttl_s;
    updated.is_pinned = record.is_pinned;
    updated.revision = ++revision_;
    updated.request_id = std::move(record.request_id);
    updated.request_digest = std::move(record.request_digest);
    updated.scene_name = std::move(record.scene_name);
    updated.spec = std::move(record.spec);
    updated.threads = record.threads;
    updated.create_time_us = record.create_time_us;
    record = std::move(updated);
  }

  class MemoryUpload final : public Upload {
   public:
    MemoryUpload(MemoryStore& store, std::string_view sha256_hex, std::int64_t size)
        : store_(store), digest_(sha256_hex), size_(size) {}

    void Write(std::string_view bytes) override {
      is_too_long_ = is_too_long_ || static_cast<std::int64_t>(bytes_.size() + bytes.size()) > size_;
      if (!is_too_long_) bytes_.append(bytes);
    }

    bool Commit() override {
      if (is_too_long_ || static_cast<std::int64_t>(bytes_.size()) != size_ || Hex(Sha256Of(bytes_)) != digest_)
        return false;
      const std::unique_lock lock(store_.mutex_);
      store_.assets_[digest_] = std::move(bytes_);
      return true;
    }

   private:
    MemoryStore& store_;
    const std::string digest_;
    const std::int64_t size_;
    std::string bytes_;
    bool is_too_long_ = false;
  };

  std::shared_mutex mutex_;
  std::map<std::string, StoredJob, std::less<>> jobs_;
  std::map<std::int64_t, std::string> deletions_;  // ids by revision
  std::int64_t revision_ = 0;
  std::map<std::string, std::string, std::less<>> ids_by_request_;
  std::map<std::string, std::string, std::less<>> assets_;
  std::map<std::string, std::weak_ptr<MemoryFrameStore>, std::less<>> staged_;  // of jobs that are not there yet
  std::optional<Transfers> transfers_;
  std::int64_t next_transfer_ = 0;
};

}  // namespace

std::unique_ptr<Store> MakeMemoryStore() { return std::make_unique<MemoryStore>(); }

}  // namespace fascicle::server
