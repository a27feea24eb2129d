#ifndef FASCICLE_SERVER_STORE_STORE_H_
#define FASCICLE_SERVER_STORE_STORE_H_

#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/store/job_query.h"

namespace fascicle::server {

// The store holds the entire state of the server: only what is stored survives a restart. It contains bytes and
// records, and knows neither solvers nor wire messages. All functions are thread-safe, block on disk, and throw
// StoreError if the storage fails (disk full, damaged file); all other outcomes are return values.

class StoreError : public std::exception {
 public:
  explicit StoreError(std::string what) : what_(std::move(what)) {}
  const char* what() const noexcept override { return what_.c_str(); }

 private:
  std::string what_;
};

// Stored bytes are not those that were written: their checksum or the structure of their file is wrong.
class DamageError : public StoreError {
 public:
  using StoreError::StoreError;
};

// The disk is full. Writes succeed again as soon as there is room.
class NoSpaceError : public StoreError {
 public:
  using StoreError::StoreError;
};

// A request id was used for another job.
class RequestReusedError : public StoreError {
 public:
  RequestReusedError(const std::string& request_id, std::string job_id)
      : StoreError("request_id " + request_id + " was used for another job"), job_id_(std::move(job_id)) {}
  // The job for which it was used.
  const std::string& job_id() const { return job_id_; }

 private:
  std::string job_id_;
};

// As Job.State in job.proto; the numbers are stored.
enum class JobState {
  kQueued = 1,
  kStarting = 2,
  kRunning = 3,
  kCancelling = 4,
  kSucceeded = 5,
  kFailed = 6,
  kCancelled = 7,
  kPaused = 8,
  kPausing = 9
};
inline bool IsFinal(JobState s) {
  return s == JobState::kSucceeded || s == JobState::kFailed || s == JobState::kCancelled;
}

struct JobRecord {
  std::string id;              // 26 characters, sortable by creation
  std::string request_id;      // may be empty; unique otherwise
  std::string request_digest;  // of the request, to tell a repetition from a different request with the same id
  std::string scene_name;
  std::string spec;  // serialized job specification, opaque here
  int threads = 1;
  JobState state = JobState::kQueued;
  std::string failure;   // serialized failure, opaque here; empty: none
  std::string profile;   // serialized profile, opaque here; empty: none
  std::string warnings;  // serialized warnings, opaque here; empty: none
  std::int64_t attempt = 0;
  std::int64_t generation = 1;
  std::int64_t create_time_us = 0;  // since the Unix epoch
  std::int64_t start_time_us = 0;   // 0: not yet
  std::int64_t end_time_us = 0;     // 0: not yet
  double fraction = 0;              // of simulated time, as last stored
  double time = 0;                  // simulated time, as last stored [s]
  std::int64_t step = 0;            // as last stored
  std::int64_t frame_count = 0;     // as last stored; exact once the state is final
  std::int64_t stored_bytes = 0;    // of frames and geometry, as last stored; exact once the state is final
  // How much speaks for this job as the cause when the process ended without stopping it, since its last progress, and
  // the place that it had reached then; see job_manager.cc.
  std::int64_t crash_score = 0;
  std::int64_t crash_place = -1;
  std::string owner = {};                          // who submitted it; empty: nobody in particular
  std::map<std::string, std::string> labels = {};  // keys without '=', keys and values without line feeds
  int priority = 0;
  std::int64_t ttl_s = 0;        // how long it is kept after its end [s]; 0: as the server decides
  bool is_pinned = false;        // kept until somebody deletes it
  std::int64_t first_frame = 0;  // frames before it were removed to make room
  std::int64_t revision = 0;     // number of its last change among the changes of all jobs; set by the store
};

// Changes of jobs in the order in which they became durable.
struct JobChanges {
  std::vector<JobRecord> changed;    // without spec; each as it is now
  std::vector<std::string> deleted;  // ids
  std::int64_t revision = 0;         // of the last change that is included
};

// Jobs. Changes are durable (fsync) when a function returns.
class JobStore {
 public:
  virtual ~JobStore() = default;
  // Creates jobs together: either all of them are stored, or none. A job whose request id was used for an earlier one
  // is not created again; its place in the result has the earlier one, the others have nothing. Request ids of `jobs`
  // differ, unless they are empty. Throws RequestReusedError if a request id was used with another request digest, and
  // NoSpaceError if the disk is almost full.
  virtual std::vector<std::optional<JobRecord>> CreateJobs(std::span<const JobRecord> jobs) = 0;
  // The same for one job. False if there was an earlier one, which is then in `existing` (not null).
  bool CreateJob(const JobRecord& job, JobRecord* existing) {
    std::optional<JobRecord> earlier = std::move(CreateJobs({&job, 1}).front());
    if (!earlier) return true;
    *existing = *std::move(earlier);
    return false;
  }
  virtual std::optional<JobRecord> GetJob(std::string_view id) = 0;
  // The job with a request id; nothing for an empty one.
  virtual std::optional<JobRecord> FindRequest(std::string_view request_id) = 0;
  // Newest first, without `spec`: ids below `before_id` (empty: from the newest), states in `states` (empty: all).
  virtual std::vector<JobRecord> ListJobs(int limit, std::string_view before_id,
                                          const std::vector<JobState>& states) = 0;
  // Jobs that pass a filter, in the order asked for, without `spec`.
  virtual std::vector<JobRecord> FindJobs(const JobQuery& query) = 0;
  // What is stored of the jobs of an owner, or of all without an owner given [byte].
  virtual std::int64_t StoredBytesOf(const std::optional<std::string>& owner) = 0;
  // Writes state, failure, profile, warnings, attempt, generation, start and end time, progress, counts, first frame
  // and crashes of a job. Does nothing if the job does not exist.
  virtual void UpdateJob(const JobRecord& job) = 0;
  // Writes labels, priority, ttl and pin of a job. False if it does not exist.
  virtual bool UpdateSettings(const JobRecord& job) = 0;
  // Removes the job with its frames. False if it does not exist.
  virtual bool DeleteJob(std::string_view id) = 0;
  // Changes after `revision`, at most `limit` jobs; at revision 0 nothing had happened. Deletions up to revision
  // `deletions_after` are left out. Nothing if deletions that belong to the answer were forgotten (at least the last
  // 10,000 are remembered), or if `revision` is yet to come.
  virtual std::optional<JobChanges> ChangesAfter(std::int64_t revision, std::int64_t deletions_after, int limit) = 0;
  // Number of the last change that is durable. Cheap.
  virtual std::int64_t Revision() = 0;
};

struct FrameRecord {
  std::int64_t index = 0;
  double time = 0;  // [s]
  std::int64_t step = 0;
  std::int64_t size = 0;
  std::string digest;  // 32 bytes
};

// The state of a run right after a frame.
struct CheckpointRecord {
  std::int64_t frame = 0;
  std::string bytes;
};

// A line of the log of a job.
struct LogRow {
  std::int64_t number = 0;
  std::string bytes;
};

// An input of a job.
struct SteeringRecord {
  std::int64_t sequence = 0;         // from 1
  std::optional<std::int64_t> step;  // with which it takes effect, if that is known
  std::optional<double> time;        // otherwise: with the first step that does not begin before this time [s]
  std::int64_t accept_time_us = 0;   // since the Unix epoch
  std::string input;                 // serialized contents, opaque here
};

// The frames of one job, its inputs and its log, in a file of their own. Writers wait for each other; readers do not
// wait. What is read is compared with the checksum stored with it: DamageError.
class FrameStore {
 public:
  static constexpr std::int64_t kChunkSize = 1 << 20;  // size of the chunks in which frames and geometry are stored

  virtual ~FrameStore() = default;
  // Replaces the geometry; does nothing if it is the same.
  virtual void PutGeometry(std::string_view bytes) = 0;
  // Size of the geometry; nothing if there is none.
  virtual std::optional<std::int64_t> GeometrySize() = 0;
  // Chunk number `chunk` of the geometry; nothing if it does not exist.
  virtual std::optional<std::string> ReadGeometryChunk(std::int64_t chunk) = 0;
  // Appends a frame and, if `checkpoint` is not empty, stores that, and the lines of `log` as by PutLog, in one
  // transaction. The last two checkpoints are kept. If a frame with this index and digest is already stored, it is left
  // as it is (a restart repeats frames after its checkpoint), but written anew if its bytes are damaged. If the digest
  // differs, this frame and all later ones are replaced, checkpoints that belong to them are removed, and true is
  // returned. The caller must increment the job's generation before such a call, so that no reader sees the new frame
  // under the old generation. Throws std::invalid_argument unless 0 <= index <= frame_count(). `frame.size` is ignored;
  // the size of `bytes` is stored.
  virtual bool PutFrame(const FrameRecord& frame, std::string_view bytes, std::string_view checkpoint,
                        std::span<const LogRow> log) = 0;
  bool PutFrame(const FrameRecord& frame, std::string_view bytes, std::string_view checkpoint) {
    return PutFrame(frame, bytes, checkpoint, {});
  }
  // Removes all checkpoints, so that the next run starts at rest.
  virtual void DropCheckpoints() = 0;
  // The newest undamaged checkpoint of a frame before `frame`.
  virtual std::optional<CheckpointRecord> GetCheckpoint(std::int64_t frame) = 0;
  // Frames with index >= start, at most `limit`, in order.
  virtual std::vector<FrameRecord> ListFrames(std::int64_t start, int limit) = 0;
  // How often frames have been replaced by others since this store was opened.
  virtual std::int64_t replacements() = 0;
  // Frames 0 .. count - 1 are stored.
  virtual std::int64_t frame_count() = 0;
  virtual std::int64_t stored_bytes() = 0;
  // Chunk number `chunk` of a frame; nothing if it does not exist.
  virtual std::optional<std::string> ReadChunk(std::int64_t index, std::int64_t chunk) = 0;

  // Of a long log the first and the last lines are kept.
  static constexpr std::int64_t kFirstLines = 1'000, kLastLines = 20'000;
  // Stores lines of the log, with ascending numbers. Those that are stored already are left as they are (a restart
  // repeats lines after its checkpoint); if one differs, it and all later ones are replaced.
  virtual void PutLog(std::span<const LogRow> lines) = 0;
  // Lines with number >= start, at most `limit`, in order.
  virtual std::vector<LogRow> ReadLog(std::int64_t start, int limit) = 0;
  // The number after that of the last line; 0 if there is none.
  virtual std::int64_t log_end() = 0;

  // Stores an input, or replaces the one with the same sequence number. Durable on return.
  virtual void PutSteering(const SteeringRecord& record) = 0;
  // Inputs with sequence >= start, at most `limit`, in order.
  virtual std::vector<SteeringRecord> ListSteering(std::int64_t start, int limit) = 0;
};

struct AssetRecord {
  std::string sha256_hex;
  std::int64_t size = 0;  // [byte]
};

// Files that scenes need, identified by digest.
class AssetStore {
 public:
  // An upload in progress. Without Commit, its destructor removes everything.
  class Upload {
   public:
    virtual ~Upload() = default;
    virtual void Write(std::string_view bytes) = 0;
    // False, and nothing stored, if size or digest are not as announced, or if the digest is not 64 digits 0-9a-f.
    virtual bool Commit() = 0;
  };

  virtual ~AssetStore() = default;
  virtual bool HasAsset(std::string_view sha256_hex) = 0;
  virtual std::unique_ptr<Upload> BeginUpload(std::string_view sha256_hex, std::int64_t size) = 0;
  // Throws StoreError if the stored bytes are damaged.
  virtual std::optional<std::string> ReadAsset(std::string_view sha256_hex) = 0;
  // All assets that nobody stored or asked for (HasAsset) within the last hour.
  virtual std::vector<AssetRecord> ListUnusedAssets() = 0;
  // Removes an asset. False if there is none, or if it was stored or asked for within the last hour.
  virtual bool RemoveUnusedAsset(std::string_view sha256_hex) = 0;
};

// The complete store. The shared frame store of a job stays usable until it is released, even if the job is deleted.
class Store : public JobStore, public AssetStore {
 public:
  // Opens the frame store, and creates it for a job without frames. Null if there is no such job.
  virtual std::shared_ptr<FrameStore> OpenFrames(std::string_view job_id) = 0;
  // Frames of a job that is not there yet: CreateJob with this id takes them over. Until then nobody else sees them,
  // and they are removed with the last reference. Null if the id is taken.
  virtual std::shared_ptr<FrameStore> StageFrames(std::string_view job_id) = 0;
  // Path of a new file for a job that is exported or imported. The caller removes the file.
  virtual std::string NewTransferPath() = 0;
  // Updates the record of a job that does not run, and removes its frames, geometry, checkpoints and log; its inputs
  // stay. False, without any change, if somebody has them open.
  virtual bool RemoveFrames(const JobRecord& job) = 0;
  // Why nothing new should be stored, for users, such as a disk that is almost full; empty if all is well. Deleting
  // jobs and updating their records may still be possible. Cheap.
  virtual std::string Problem() = 0;
  // How much more may be stored [byte].
  virtual std::int64_t Room() = 0;
};

// In memory, for tests and for an EmbeddedServer without a data directory; nothing survives it.
std::unique_ptr<Store> MakeMemoryStore();
// In a directory: control.db and its copy, jobs/{id}.db, assets/ab/{sha256}. Creates the directory. Throws StoreError
// if it is in use by another process, on a network filesystem, or written by a newer version. `least_free`: free disk
// space below which nothing new is stored [byte]; negative: see DiskReserve.
std::unique_ptr<Store> OpenSqliteStore(const std::string& directory, std::int64_t least_free = -1);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_STORE_H_
