#ifndef FASCICLE_SERVER_STORE_FRAME_DATABASE_H_
#define FASCICLE_SERVER_STORE_FRAME_DATABASE_H_

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/database.h"
#include "server/store/reader_pool.h"
#include "server/store/store.h"

namespace fascicle::server {

// The frames of one job, its inputs and its log, in jobs/{id}.db. Thread-safe.
class FrameDatabase final : public FrameStore {
 public:
  // `held`, the lock of the directory, is kept as long as this object lives.
  FrameDatabase(const std::string& path, std::shared_ptr<void> held);
  ~FrameDatabase() override;

  void PutGeometry(std::string_view bytes) override;
  std::optional<std::int64_t> GeometrySize() override;
  std::optional<std::string> ReadGeometryChunk(std::int64_t chunk) override;
  using FrameStore::PutFrame;
  bool PutFrame(const FrameRecord& frame, std::string_view bytes, std::string_view checkpoint,
                std::span<const LogRow> log) override;
  void DropCheckpoints() override;
  std::optional<CheckpointRecord> GetCheckpoint(std::int64_t frame) override;
  std::vector<FrameRecord> ListFrames(std::int64_t start, int limit) override;
  std::int64_t replacements() override { return replacements_; }
  std::int64_t frame_count() override { return frame_count_; }
  std::int64_t stored_bytes() override { return stored_bytes_; }
  std::optional<std::string> ReadChunk(std::int64_t index, std::int64_t chunk) override;
  void PutLog(std::span<const LogRow> lines) override;
  std::vector<LogRow> ReadLog(std::int64_t start, int limit) override;
  std::int64_t log_end() override { return log_end_; }
  void PutSteering(const SteeringRecord& record) override;
  std::vector<SteeringRecord> ListSteering(std::int64_t start, int limit) override;

  // Whether the file is removed with this object: its job has been deleted, or is not there yet.
  void RemoveWhenClosed(bool remove = true) { remove_ = remove; }

  // Removes the file of a job, SQLite's files beside it, and the copy of its inputs.
  static void Remove(const std::string& path);

  // The first and the last step of removing frames; between them, the job's record is written. A power cut loses no
  // input. Nobody may have the file open.
  // Writes a copy with the inputs only, path + kInputsSuffix, which is an empty file if there are none. Throws if an
  // input can't be read or copied.
  static void CopyInputs(const std::string& path);
  // Replaces the file by that copy, or removes it if the copy is empty.
  static void KeepCopiedInputs(const std::string& path);
  static constexpr const char* kInputsSuffix = ".inputs";

 private:
  struct Reader;
  struct Connections;  // everything that has the file open

  enum class Stored { kNot, kSame, kDamaged, kDifferent };
  // What is stored of a frame with this index and digest.
  Stored Find(const FrameRecord& frame);
  bool HasGeometry(std::string_view bytes);
  void InsertFrame(const FrameRecord& frame, std::string_view bytes);
  void DeleteFramesFrom(std::int64_t index);
  void InsertCheckpoint(std::int64_t frame, std::string_view bytes);
  // The first line of `lines` that is not stored yet, or differs from the stored one. Lines between the first and the
  // last ones count as stored.
  std::span<const LogRow> NewLines(std::span<const LogRow> lines);
  // Within a transaction; lines: of NewLines. Returns the end of the log.
  std::int64_t InsertLog(std::span<const LogRow> lines);
  void Count();

  const std::shared_ptr<void> held_;
  const std::string path_;
  std::mutex write_mutex_;
  std::unique_ptr<Connections> connections_;
  std::atomic<std::int64_t> replacements_ = 0;
  std::atomic<std::int64_t> frame_count_ = 0;
  std::atomic<std::int64_t> stored_bytes_ = 0;
  std::atomic<std::int64_t> log_end_ = 0;
  std::atomic<bool> remove_ = false;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_FRAME_DATABASE_H_
