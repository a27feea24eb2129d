#include "server/store/frame_database.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace fascicle::server {
namespace {

constexpr int kFrameApplicationId = 0x46534346;  // "FSCF"
// A chunk of a frame fills 32 pages. Larger pages make large blobs faster, but small frames larger.
constexpr int kPageSize = 32768;

constexpr std::array<const char*, 1> kFrameFormats = {
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

}  // namespace

struct FrameDatabase::Reader {
  explicit Reader(const std::string& path) : database(path, Database::Mode::kReadOnly) {}

  Database database;
  Statement geometry = database.Prepare("SELECT bytes FROM geometry ORDER BY chunk");
  Statement checkpoint = database.Prepare("SELECT bytes FROM checkpoint");
  Statement frames =
      database.Prepare("SELECT idx, time, step, size, digest FROM frames WHERE idx >= ? ORDER BY idx LIMIT ?");
  Statement chunk = database.Prepare("SELECT bytes FROM chunks WHERE frame = ? AND chunk = ?");
};

struct FrameDatabase::Connections {
  explicit Connections(const std::string& path)
      : database(OpenFormatted(path, kFrameApplicationId, kFrameFormats, kPageSize)),
        readers([path] { return std::make_unique<Reader>(path); }) {}

  Database database;
  Statement insert_frame =
      database.Prepare("INSERT INTO frames (idx, time, step, size, digest) VALUES (?, ?, ?, ?, ?)");
  Statement insert_chunk = database.Prepare("INSERT INTO chunks (frame, chunk, bytes) VALUES (?, ?, ?)");
  Statement digest = database.Prepare("SELECT digest FROM frames WHERE idx = ?");
  Statement delete_frames = database.Prepare("DELETE FROM frames WHERE idx >= ?");
  Statement delete_checkpoint = database.Prepare("DELETE FROM checkpoint WHERE frame >= ?");
  Statement put_checkpoint = database.Prepare("REPLACE INTO checkpoint (id, frame, bytes) VALUES (0, ?, ?)");
  Statement insert_geometry = database.Prepare("INSERT INTO geometry (chunk, bytes) VALUES (?, ?)");
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
  for (const char* suffix : {"-wal", "-shm", ""}) std::filesystem::remove(path + suffix, ignored);
}

void FrameDatabase::Count() {
  Database& database = connections_->database;
  frame_count_ = database.QueryInt("SELECT count(*) FROM frames");
  stored_bytes_ = database.QueryInt(
      "SELECT (SELECT ifnull(sum(size), 0) FROM frames) + (SELECT ifnull(sum(length(bytes)), 0) FROM geometry)");
}

void FrameDatabase::PutGeometry(std::string_view bytes) {
  const std::lock_guard lock(write_mutex_);
  if (GetGeometry() == bytes) return;
  Transaction transaction(connections_->database);
  connections_->database.Execute("DELETE FROM geometry");
  ForEachChunk(bytes, [&](std::int64_t number, std::string_view chunk) {
    connections_->insert_geometry.Run(number, Blob{chunk});
  });
  transaction.Commit();
  Count();
}

std::optional<std::string> FrameDatabase::GetGeometry() {
  return connections_->readers.With([](Reader& reader) {
    std::optional<std::string> bytes;
    Rows rows = reader.geometry.Query();
    while (rows.Next()) {
      if (!bytes) bytes.emplace();
      bytes->append(rows.Bytes(0));
    }
    return bytes;
  });
}

bool FrameDatabase::PutFrame(const FrameRecord& frame, std::string_view bytes, std::string_view checkpoint) {
  const std::lock_guard lock(write_mutex_);
  if (frame.index < 0 || frame.index > frame_count_) {
    throw std::invalid_argument("frame " + std::to_string(frame.index) + " does not follow the stored ones");
  }
  std::string stored_digest;
  const bool is_there = frame.index < frame_count_;
  if (is_there) {
    Rows rows = connections_->digest.Query(frame.index);
    if (rows.Next()) stored_digest = rows.String(0);
  }
  const bool is_same = is_there && stored_digest == frame.digest;
  if (is_same && checkpoint.empty()) return false;

  Transaction transaction(connections_->database);
  if (is_there && !is_same) DeleteFramesFrom(frame.index);
  if (!is_same) InsertFrame(frame, bytes);
  if (!checkpoint.empty()) connections_->put_checkpoint.Run(frame.index, Blob{checkpoint});
  transaction.Commit();
  if (is_there && !is_same) {
    Count();
  } else if (!is_there) {
    stored_bytes_ += static_cast<std::int64_t>(bytes.size());
    ++frame_count_;
  }
  return is_there && !is_same;
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
  connections_->delete_checkpoint.Run(index);
}

std::optional<std::string> FrameDatabase::GetCheckpoint() {
  return connections_->readers.With([](Reader& reader) -> std::optional<std::string> {
    Rows rows = reader.checkpoint.Query();
    if (!rows.Next()) return std::nullopt;
    return rows.String(0);
  });
}

std::vector<FrameRecord> FrameDatabase::ListFrames(std::int64_t start, int limit) {
  return connections_->readers.With([&](Reader& reader) {
    std::vector<FrameRecord> frames;
    Rows rows = reader.frames.Query(start, limit < 0 ? 0 : limit);  // SQL: LIMIT < 0 is no limit
    while (rows.Next()) frames.push_back(ReadFrame(rows));
    return frames;
  });
}

std::optional<std::string> FrameDatabase::ReadChunk(std::int64_t index, std::int64_t chunk) {
  return connections_->readers.With([&](Reader& reader) -> std::optional<std::string> {
    Rows rows = reader.chunk.Query(index, chunk);
    if (!rows.Next()) return std::nullopt;
    return rows.String(0);
  });
}

}  // namespace fascicle::server
