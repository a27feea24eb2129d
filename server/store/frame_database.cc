#include "server/store/frame_database.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace fascicle::server {
namespace {

constexpr int kFrameApplicationId = 0x46534346;  // "FSCF"
// A chunk of a frame fills 32 pages. Larger pages make large blobs faster, but small frames larger.
constexpr int kPageSize = 32768;

constexpr std::array<const char*, 3> kFrameFormats = {
    // Format 1.
    R"(CREATE TABLE frames (
         idx INTEGER PRIMARY KEY,
         time REAL NOT NULL,
         step INTEGER NOT NULL,
         size INTEGER NOT NULL,
         digest BLOB NOT NULL
       ) STRICT;
       CREATE TABLE chunks (
         frame INTEGER NOT NULL REFERENCES frames (idx) ON DELETE CASCADE,
         chunk INTEGER NOT NULL,
         bytes BLOB NOT NULL,
         PRIMARY KEY (frame, chunk)
       ) STRICT;
       CREATE TABLE geometry (
         chunk INTEGER PRIMARY KEY,
         bytes BLOB NOT NULL
       ) STRICT;
       CREATE TABLE checkpoint (
         id INTEGER PRIMARY KEY CHECK (id = 0),
         frame INTEGER NOT NULL,
         bytes BLOB NOT NULL
       ) STRICT;)",
    // Format 2: checksums, and more than one checkpoint.
    R"(ALTER TABLE frames ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
       UPDATE frames SET checksum = row_checksum(idx, time, step, size, digest);
       ALTER TABLE chunks ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
       UPDATE chunks SET checksum = row_checksum(frame, chunk, bytes);
       ALTER TABLE geometry ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
       UPDATE geometry SET checksum = row_checksum(chunk, bytes);
       CREATE TABLE checkpoints (
         frame INTEGER PRIMARY KEY,
         bytes BLOB NOT NULL,
         checksum INTEGER NOT NULL
       ) STRICT;
       INSERT INTO checkpoints SELECT frame, bytes, row_checksum(frame, bytes) FROM checkpoint;
       DROP TABLE checkpoint;)",
    // Format 3: inputs and the log.
    R"(CREATE TABLE steering (
         sequence INTEGER PRIMARY KEY,
         step INTEGER,
         time REAL,
         accept_time_us INTEGER NOT NULL,
         input BLOB NOT NULL,
         checksum INTEGER NOT NULL
       ) STRICT;
       CREATE TABLE log (
         number INTEGER PRIMARY KEY,
         bytes BLOB NOT NULL,
         checksum INTEGER NOT NULL
       ) STRICT;)"};

// Calls put(number, bytes) for each chunk; empty data has one empty chunk.
template <class Put>
void ForEachChunk(std::string_view bytes, const Put& put) {
  constexpr auto kSize = static_cast<std::size_t>(FrameStore::kChunkSize);
  std::int64_t number = 0;
  do {
    put(number++, bytes.substr(0, kSize));
    bytes.remove_prefix(std::min(kSize, bytes.size()));
  } while (!bytes.empty());
}

FrameRecord ReadFrame(const Rows& row) { return {row.Int(0), row.Real(1), row.Int(2), row.Int(3), row.String(4)}; }

// Throws unless the column, a comparison of checksums, is true.
void CheckIntact(const Rows& row, int column, const Database& database, const std::string& what) {
  if (row.Int(column) != 1) throw DamageError(database.path() + ": " + what + " is damaged");
}

}  // namespace

struct FrameDatabase::Reader {
  explicit Reader(const std::string& path) : database(path, Database::Mode::kReadOnly) {}

  Database database;
  Statement geometry_size = database.Prepare("SELECT count(*), sum(length(bytes)) FROM geometry");
  Statement geometry =
      database.Prepare("SELECT bytes, row_checksum(chunk, bytes) = checksum FROM geometry WHERE chunk = ?");
  Statement checkpoint = database.Prepare(
      "SELECT frame, bytes FROM checkpoints WHERE frame < ? AND row_checksum(frame, bytes) = checksum "
      "ORDER BY frame DESC LIMIT 1");
  Statement frames = database.Prepare(
      "SELECT idx, time, step, size, digest, row_checksum(idx, time, step, size, digest) = checksum FROM frames "
      "WHERE idx >= ? ORDER BY idx LIMIT ?");
  Statement chunk = database.Prepare(
      "SELECT bytes, row_checksum(frame, chunk, bytes) = checksum FROM chunks WHERE frame = ? AND chunk = ?");
  Statement log = database.Prepare(
      "SELECT number, bytes, row_checksum(number, bytes) = checksum FROM log WHERE number >= ? ORDER BY number LIMIT "
      "?");
  Statement steering = database.Prepare(
      "SELECT sequence, step, time, accept_time_us, input, step IS NOT NULL, time IS NOT NULL, row_checksum(sequence, "
      "step, time, accept_time_us, input) = checksum FROM steering WHERE sequence >= ? ORDER BY sequence LIMIT ?");
};

struct FrameDatabase::Connections {
  explicit Connections(const std::string& path)
      : database(OpenFormatted(path, kFrameApplicationId, kFrameFormats, kPageSize)),
        readers([path] { return std::make_unique<Reader>(path); }) {}

  Database database;
  Statement insert_frame = database.Prepare(
      "INSERT INTO frames (idx, time, step, size, digest, checksum) VALUES (?1, ?2, ?3, ?4, ?5, row_checksum(?1, ?2, "
      "?3, ?4, ?5))");
  Statement insert_chunk = database.Prepare(
      "REPLACE INTO chunks (frame, chunk, bytes, checksum) VALUES (?1, ?2, ?3, row_checksum(?1, ?2, ?3))");
  Statement digest = database.Prepare(
      "SELECT digest, row_checksum(idx, time, step, size, digest) = checksum FROM frames WHERE idx = ?");
  // Whether all chunks of a frame are there and intact.
  Statement is_intact = database.Prepare(
      "SELECT sum(length(bytes)) = (SELECT size FROM frames WHERE idx = ?1) AND min(row_checksum(frame, chunk, bytes) "
      "= checksum) FROM chunks WHERE frame = ?1");
  Statement delete_frame = database.Prepare("DELETE FROM frames WHERE idx = ?");
  Statement delete_frames = database.Prepare("DELETE FROM frames WHERE idx >= ?");
  Statement delete_checkpoints = database.Prepare("DELETE FROM checkpoints WHERE frame >= ?");
  Statement put_checkpoint =
      database.Prepare("REPLACE INTO checkpoints (frame, bytes, checksum) VALUES (?1, ?2, row_checksum(?1, ?2))");
  Statement keep_checkpoints = database.Prepare(
      "DELETE FROM checkpoints WHERE frame NOT IN (SELECT frame FROM checkpoints ORDER BY frame DESC LIMIT 2)");
  Statement insert_geometry =
      database.Prepare("INSERT INTO geometry (chunk, bytes, checksum) VALUES (?1, ?2, row_checksum(?1, ?2))");
  Statement line = database.Prepare("SELECT bytes FROM log WHERE number = ?");
  Statement insert_line =
      database.Prepare("INSERT INTO log (number, bytes, checksum) VALUES (?1, ?2, row_checksum(?1, ?2))");
  Statement delete_lines = database.Prepare("DELETE FROM log WHERE number >= ?1 AND number < ?2");
  Statement put_steering = database.Prepare(
      "REPLACE INTO steering (sequence, step, time, accept_time_us, input, checksum) VALUES (?1, ?2, ?3, ?4, ?5, "
      "row_checksum(?1, ?2, ?3, ?4, ?5))");
  ReaderPool<Reader> readers;
};

FrameDatabase::FrameDatabase(const std::string& path, std::shared_ptr<void> held)
    : held_(std::move(held)), path_(path), connections_(std::make_unique<Connections>(path)) {
  Count();
}

FrameDatabase::~FrameDatabase() {
  connections_.reset();
  if (remove_) Remove(path_);
}

void FrameDatabase::Remove(const std::string& path) {
  std::error_code ignored;  // the file is removed when the store is opened the next time
  for (const char* suffix : {"-wal", "-shm", "", kInputsSuffix}) std::filesystem::remove(path + suffix, ignored);
}

void FrameDatabase::CopyInputs(const std::string& path) {
  constexpr int kAll = std::numeric_limits<int>::max();
  const std::string copy = path + kInputsSuffix;
  Remove(copy);
  // Closed, a database is without a write-ahead log, which would not fit the copy.
  const std::vector<SteeringRecord> inputs = FrameDatabase(path, nullptr).ListSteering(0, kAll);
  if (inputs.empty()) {
    std::ofstream(copy).flush();
  } else {
    for (FrameDatabase database(copy, nullptr); const SteeringRecord& input : inputs) database.PutSteering(input);
    // On a full disk, rows may have stayed in the write-ahead log.
    if (std::filesystem::exists(copy + "-wal")) throw NoSpaceError(copy + ": the inputs could not be copied");
  }
  SyncFile(copy);
  SyncParent(copy);
}

void FrameDatabase::KeepCopiedInputs(const std::string& path) {
  const std::string copy = path + kInputsSuffix;
  for (const char* suffix : {"-wal", "-shm"}) std::filesystem::remove(path + suffix);
  if (std::filesystem::file_size(copy) > 0) {
    std::filesystem::rename(copy, path);
  } else {
    std::filesystem::remove(path);
    SyncParent(path);
    std::filesystem::remove(copy);
  }
  SyncParent(path);
}

void FrameDatabase::Count() {
  Database& database = connections_->database;
  frame_count_ = database.QueryInt("SELECT count(*) FROM frames");
  stored_bytes_ = database.QueryInt(
      "SELECT (SELECT ifnull(sum(size), 0) FROM frames) + (SELECT ifnull(sum(length(bytes)), 0) FROM geometry)");
  log_end_ = database.QueryInt("SELECT ifnull(max(number) + 1, 0) FROM log");
}

bool FrameDatabase::HasGeometry(std::string_view bytes) {
  try {
    if (GeometrySize() != static_cast<std::int64_t>(bytes.size())) return false;
    bool same = true;
    ForEachChunk(
        bytes, [&](std::int64_t number, std::string_view chunk) { same = same && ReadGeometryChunk(number) == chunk; });
    return same;
  } catch (const DamageError&) {
    return false;
  }
}

void FrameDatabase::PutGeometry(std::string_view bytes) {
  const std::lock_guard lock(write_mutex_);
  if (HasGeometry(bytes)) return;
  Transaction transaction(connections_->database);
  connections_->database.Execute("DELETE FROM geometry");
  ForEachChunk(bytes, [&](std::int64_t number, std::string_view chunk) {
    connections_->insert_geometry.Run(number, Blob{chunk});
  });
  transaction.Commit();
  Count();
}

std::optional<std::int64_t> FrameDatabase::GeometrySize() {
  return connections_->readers.With([](Reader& reader) -> std::optional<std::int64_t> {
    Rows rows = reader.geometry_size.Query();
    if (!rows.Next() || rows.Int(0) == 0) return std::nullopt;
    return rows.Int(1);
  });
}

std::optional<std::string> FrameDatabase::ReadGeometryChunk(std::int64_t chunk) {
  return connections_->readers.With([&](Reader& reader) -> std::optional<std::string> {
    Rows rows = reader.geometry.Query(chunk);
    if (!rows.Next()) return std::nullopt;
    CheckIntact(rows, 1, reader.database, "the geometry");
    return rows.String(0);
  });
}

FrameDatabase::Stored FrameDatabase::Find(const FrameRecord& frame) {
  if (frame.index >= frame_count_) return Stored::kNot;
  {
    Rows rows = connections_->digest.Query(frame.index);
    if (!rows.Next() || rows.Int(1) != 1) return Stored::kDamaged;
    if (rows.Bytes(0) != frame.digest) return Stored::kDifferent;
  }
  Rows rows = connections_->is_intact.Query(frame.index);
  return rows.Next() && rows.Int(0) == 1 ? Stored::kSame : Stored::kDamaged;
}

bool FrameDatabase::PutFrame(const FrameRecord& frame, std::string_view bytes, std::string_view checkpoint,
                             std::span<const LogRow> log) {
  const std::lock_guard lock(write_mutex_);
  if (frame.index < 0 || frame.index > frame_count_) {
    throw std::invalid_argument("frame " + std::to_string(frame.index) + " does not follow the stored ones");
  }
  const Stored stored = Find(frame);
  const std::span<const LogRow> lines = NewLines(log);
  if (stored == Stored::kSame && checkpoint.empty() && lines.empty()) return false;

  Transaction transaction(connections_->database);
  if (stored == Stored::kDifferent) DeleteFramesFrom(frame.index);
  if (stored == Stored::kDamaged) connections_->delete_frame.Run(frame.index);
  if (stored != Stored::kSame) InsertFrame(frame, bytes);
  if (!checkpoint.empty()) InsertCheckpoint(frame.index, checkpoint);
  const std::int64_t log_end = InsertLog(lines);
  transaction.Commit();
  if (stored == Stored::kDifferent) ++replacements_;
  log_end_ = log_end;
  if (stored == Stored::kNot) {
    stored_bytes_ += static_cast<std::int64_t>(bytes.size());
    ++frame_count_;
  } else if (stored != Stored::kSame) {
    Count();
  }
  return stored == Stored::kDifferent;
}

void FrameDatabase::InsertFrame(const FrameRecord& frame, std::string_view bytes) {
  connections_->insert_frame.Run(frame.index, frame.time, frame.step, static_cast<std::int64_t>(bytes.size()),
                                 Blob{frame.digest});
  ForEachChunk(bytes, [&](std::int64_t number, std::string_view chunk) {
    connections_->insert_chunk.Run(frame.index, number, Blob{chunk});
  });
}

void FrameDatabase::DeleteFramesFrom(std::int64_t index) {
  connections_->delete_frames.Run(index);  // and their chunks
  connections_->delete_checkpoints.Run(index);
}

void FrameDatabase::InsertCheckpoint(std::int64_t frame, std::string_view bytes) {
  connections_->put_checkpoint.Run(frame, Blob{bytes});
  connections_->keep_checkpoints.Run();
}

void FrameDatabase::DropCheckpoints() {
  const std::lock_guard lock(write_mutex_);
  connections_->delete_checkpoints.Run(0);
}

std::optional<CheckpointRecord> FrameDatabase::GetCheckpoint(std::int64_t frame) {
  return connections_->readers.With([&](Reader& reader) -> std::optional<CheckpointRecord> {
    Rows rows = reader.checkpoint.Query(frame);
    if (!rows.Next()) return std::nullopt;
    return CheckpointRecord{rows.Int(0), rows.String(1)};
  });
}

std::vector<FrameRecord> FrameDatabase::ListFrames(std::int64_t start, int limit) {
  return connections_->readers.With([&](Reader& reader) {
    std::vector<FrameRecord> frames;
    Rows rows = reader.frames.Query(start, limit < 0 ? 0 : limit);  // SQL: LIMIT < 0 is no limit
    while (rows.Next()) {
      CheckIntact(rows, 5, reader.database, "the record of frame " + std::to_string(rows.Int(0)));
      frames.push_back(ReadFrame(rows));
    }
    return frames;
  });
}

std::optional<std::string> FrameDatabase::ReadChunk(std::int64_t index, std::int64_t chunk) {
  return connections_->readers.With([&](Reader& reader) -> std::optional<std::string> {
    Rows rows = reader.chunk.Query(index, chunk);
    if (!rows.Next()) return std::nullopt;
    CheckIntact(rows, 1, reader.database, "frame " + std::to_string(index));
    return rows.String(0);
  });
}

std::span<const LogRow> FrameDatabase::NewLines(std::span<const LogRow> lines) {
  const auto is_stored = [this](const LogRow& row) {
    if (row.number >= log_end_) return false;
    if (row.number >= kFirstLines && row.number < log_end_ - kLastLines) return true;
    Rows rows = connections_->line.Query(row.number);
    return rows.Next() && rows.Bytes(0) == row.bytes;
  };
  while (!lines.empty() && is_stored(lines.front())) lines = lines.subspan(1);
  return lines;
}

std::int64_t FrameDatabase::InsertLog(std::span<const LogRow> lines) {
  if (lines.empty()) return log_end_;
  connections_->delete_lines.Run(lines.front().number, INT64_MAX);
  for (const LogRow& row : lines) connections_->insert_line.Run(row.number, Blob{row.bytes});
  const std::int64_t end = lines.back().number + 1;
  connections_->delete_lines.Run(kFirstLines, end - kLastLines);
  return end;
}

void FrameDatabase::PutLog(std::span<const LogRow> lines) {
  const std::lock_guard lock(write_mutex_);
  lines = NewLines(lines);
  if (lines.empty()) return;
  Transaction transaction(connections_->database);
  const std::int64_t end = InsertLog(lines);
  transaction.Commit();
  log_end_ = end;
}

std::vector<LogRow> FrameDatabase::ReadLog(std::int64_t start, int limit) {
  return connections_->readers.With([&](Reader& reader) {
    std::vector<LogRow> lines;
    Rows rows = reader.log.Query(start, limit < 0 ? 0 : limit);
    while (rows.Next()) {
      CheckIntact(rows, 2, reader.database, "line " + std::to_string(rows.Int(0)) + " of the log");
      lines.push_back({rows.Int(0), rows.String(1)});
    }
    return lines;
  });
}

void FrameDatabase::PutSteering(const SteeringRecord& record) {
  const std::lock_guard lock(write_mutex_);
  connections_->put_steering.Run(record.sequence, record.step, record.time, record.accept_time_us, Blob{record.input});
}

std::vector<SteeringRecord> FrameDatabase::ListSteering(std::int64_t start, int limit) {
  return connections_->readers.With([&](Reader& reader) {
    std::vector<SteeringRecord> records;
    Rows rows = reader.steering.Query(start, limit < 0 ? 0 : limit);
    while (rows.Next()) {
      CheckIntact(rows, 7, reader.database, "input " + std::to_string(rows.Int(0)));
      SteeringRecord& record = records.emplace_back();
      record.sequence = rows.Int(0);
      if (rows.Int(5) == 1) record.step = rows.Int(1);
      if (rows.Int(6) == 1) record.time = rows.Real(2);
      record.accept_time_us = rows.Int(3);
      record.input = rows.String(4);
    }
    return records;
  });
}

}  // namespace fascicle::server
