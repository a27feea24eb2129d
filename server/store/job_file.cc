#include "server/store/job_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/stop.h"
#include "server/store/database.h"

namespace fascicle::server {
namespace {

constexpr int kJobFileApplicationId = 0x4653434A;  // "FSCJ"
constexpr int kJobFileFormat = 1;
constexpr auto kPart = static_cast<std::size_t>(FrameStore::kChunkSize);

// As SQLite keeps them, in the order of their names.
struct Table {
  const char* name;
  const char* sql;
};
constexpr std::array<Table, 5> kTables = {
    {{"chunks",
      "CREATE TABLE chunks (number INTEGER PRIMARY KEY, frame INTEGER NOT NULL, chunk INTEGER NOT NULL, bytes BLOB NOT "
      "NULL, checksum INTEGER NOT NULL) STRICT"},
     {"contents",
      "CREATE TABLE contents (id INTEGER PRIMARY KEY, parts INTEGER NOT NULL, geometry INTEGER NOT NULL, frames "
      "INTEGER NOT NULL, checksum INTEGER NOT NULL) STRICT"},
     {"frames",
      "CREATE TABLE frames (idx INTEGER PRIMARY KEY, time REAL NOT NULL, step INTEGER NOT NULL, size INTEGER NOT NULL, "
      "digest BLOB NOT NULL, checksum INTEGER NOT NULL) STRICT"},
     {"geometry",
      "CREATE TABLE geometry (chunk INTEGER PRIMARY KEY, bytes BLOB NOT NULL, checksum INTEGER NOT NULL) STRICT"},
     {"job", "CREATE TABLE job (part INTEGER PRIMARY KEY, bytes BLOB NOT NULL, checksum INTEGER NOT NULL) STRICT"}}};

// A new file without rows.
Database MakeTables(const std::string& path) {
  Database database(path, Database::Mode::kCreate);
  // It is of no use unless it is complete.
  for (const char* sql : {"PRAGMA page_size = 8192", "PRAGMA journal_mode = OFF", "PRAGMA synchronous = OFF"}) {
    database.Execute(sql);
  }
  database.Execute(("PRAGMA application_id = " + std::to_string(kJobFileApplicationId)).c_str());
  database.Execute(("PRAGMA user_version = " + std::to_string(kJobFileFormat)).c_str());
  for (const Table& table : kTables) database.Execute(table.sql);
  return database;
}

class JobFileWriter {
 public:
  explicit JobFileWriter(const std::string& path) : database_(MakeTables(path)) {}

  void Write(std::string_view job, FrameStore& frames, std::int64_t count, const std::function<bool()>& go_on) {
    Transaction transaction(database_);
    const std::int64_t parts = PutJob(job);
    const std::int64_t geometry = PutGeometry(frames);
    for (std::int64_t index = 0; index < count; ++index) {
      if (!go_on()) throw Stopped();
      PutFrame(frames, index);
    }
    database_.Prepare("INSERT INTO contents VALUES (0, ?1, ?2, ?3, row_checksum(0, ?1, ?2, ?3))")
        .Run(parts, geometry, count);
    transaction.Commit();
  }

 private:
  std::int64_t PutJob(std::string_view job) {
    Statement put = database_.Prepare("INSERT INTO job VALUES (?1, ?2, row_checksum(?1, ?2))");
    std::int64_t part = 0;
    for (; !job.empty(); job.remove_prefix(std::min(kPart, job.size()))) put.Run(part++, Blob{job.substr(0, kPart)});
    return part;
  }

  std::int64_t PutGeometry(FrameStore& frames) {
    Statement put = database_.Prepare("INSERT INTO geometry VALUES (?1, ?2, row_checksum(?1, ?2))");
    std::int64_t chunk = 0;
    while (const std::optional<std::string> bytes = frames.ReadGeometryChunk(chunk)) put.Run(chunk++, Blob{*bytes});
    return chunk;
  }

  void PutFrame(FrameStore& frames, std::int64_t index) {
    const std::vector<FrameRecord> records = frames.ListFrames(index, 1);
    const std::string name = "frame " + std::to_string(index);
    if (records.empty() || records[0].index != index) throw DamageError(name + " is missing");
    const FrameRecord& record = records[0];
    put_frame_.Run(index, record.time, record.step, record.size, Blob{record.digest});
    std::int64_t written = 0;
    for (std::int64_t chunk = 0; written < record.size; ++chunk) {
      const std::optional<std::string> bytes = frames.ReadChunk(index, chunk);
      if (!bytes || bytes->empty()) throw DamageError(name + " is incomplete");
      put_chunk_.Run(next_chunk_++, index, chunk, Blob{*bytes});
      written += static_cast<std::int64_t>(bytes->size());
    }
  }

  Database database_;
  Statement put_frame_ =
      database_.Prepare("INSERT INTO frames VALUES (?1, ?2, ?3, ?4, ?5, row_checksum(?1, ?2, ?3, ?4, ?5))");
  Statement put_chunk_ = database_.Prepare("INSERT INTO chunks VALUES (?1, ?2, ?3, ?4, row_checksum(?1, ?2, ?3, ?4))");
  std::int64_t next_chunk_ = 0;
};

JobFileError Damaged() { return JobFileError("the file is damaged, or not complete"); }

// Refuses what SQLite must not even look at: files of other kinds, and those with a write-ahead log.
void CheckHeader(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 100> header = {};
  const bool is_read = static_cast<bool>(file.read(header.data(), header.size()));
  if (!is_read || std::string_view(header.data(), 15) != "SQLite format 3") {
    throw JobFileError("the file is not a job that was exported: `fascicle export JOB --database FILE` writes one");
  }
  std::uint32_t application_id = 0;
  for (std::size_t k = 68; k < 72; ++k) application_id = application_id << 8 | static_cast<unsigned char>(header[k]);
  if (application_id != kJobFileApplicationId) {
    throw JobFileError(
        "the file is a database of another kind; a job in a server's data folder is exported first: `fascicle export "
        "FOLDER/jobs/ID --database FILE`");
  }
  if (header[18] != 1 || header[19] != 1) throw Damaged();
}

void CheckFormat(Database& database) {
  const std::int64_t format = database.QueryInt("PRAGMA user_version");
  if (format != kJobFileFormat) {
    throw JobFileError("the file has format " + std::to_string(format) + "; this server knows " +
                       std::to_string(kJobFileFormat) + (format > kJobFileFormat ? ": a newer one can read it" : ""));
  }
}

void CheckTables(Database& database) {
  Statement list = database.Prepare("SELECT type, name, tbl_name, sql FROM sqlite_schema ORDER BY name LIMIT 6");
  Rows rows = list.Query();
  for (const Table& table : kTables) {
    if (!rows.Next() || rows.Bytes(0) != "table" || rows.Bytes(1) != table.name || rows.Bytes(2) != table.name ||
        rows.Bytes(3) != table.sql) {
      throw JobFileError("the file has other tables than a job that was exported");
    }
  }
  if (rows.Next()) throw JobFileError("the file has more than a job that was exported");
}

// Every error of the file as one for users.
template <class Read>
auto Reading(const Read& read) {
  try {
    return read();
  } catch (const StoreError&) {  // names the server's path
    throw Damaged();
  }
}

Database Open(const std::string& path) {
  CheckHeader(path);
  return Reading([&] {
    Database database(path, Database::Mode::kUntrusted);
    CheckFormat(database);
    CheckTables(database);
    return database;
  });
}

}  // namespace

void WriteJobFile(const std::string& path, std::string_view job, FrameStore& frames, std::int64_t count,
                  const std::function<bool()>& go_on) {
  JobFileWriter(path).Write(job, frames, count, go_on);
}

struct JobFileReader::Impl {
  explicit Impl(const std::string& path)
      : database(Open(path)), bytes_left(static_cast<std::int64_t>(std::filesystem::file_size(path))) {
    Statement contents = Prepare(
        "SELECT parts, geometry, frames, row_checksum(id, parts, geometry, frames) = checksum "
        "FROM contents WHERE id = 0");
    Rows rows = contents.Query();
    if (!Reading([&] { return rows.Next(); }) || rows.Int(3) != 1) throw Damaged();
    parts = rows.Int(0);
    chunks_of_geometry = rows.Int(1);
    frames = rows.Int(2);
    if (parts < 0 || chunks_of_geometry < 0 || frames < 0) throw Damaged();
  }

  Statement Prepare(const char* sql) {
    return Reading([&] { return database.Prepare(sql); });
  }

  // Appends the bytes of a row: of its first column, if the second says that they are intact.
  template <class... Key>
  void Append(Statement& statement, std::string& bytes, std::int64_t most, const Key&... key) {
    Reading([&] {
      Rows rows = statement.Query(key...);
      if (!rows.Next() || rows.Int(1) != 1) throw Damaged();
      const std::string_view more = rows.Bytes(0);
      bytes_left -= static_cast<std::int64_t>(more.size());
      // Rows of a file that was made by hand may share their pages.
      if (more.empty() || more.size() > kPart || bytes_left < 0) throw Damaged();
      if (static_cast<std::int64_t>(bytes.size() + more.size()) > most) {
        throw JobFileError("the file has a part of more than " + std::to_string(most >> 20) + " MiB");
      }
      bytes += more;
    });
  }

  std::string ReadAll(const char* sql, std::int64_t count, std::int64_t most) {
    Statement statement = Prepare(sql);
    std::string bytes;
    for (std::int64_t number = 0; number < count; ++number) Append(statement, bytes, most, number);
    return bytes;
  }

  FrameRecord ReadRecord(std::int64_t index) {
    return Reading([&] {
      Rows rows = record.Query(index);
      if (!rows.Next() || rows.Int(4) != 1) throw Damaged();
      FrameRecord found{index, rows.Real(0), rows.Int(1), rows.Int(2), rows.String(3)};
      if (found.size < 1 || found.size > kMostFrame) throw Damaged();
      return found;
    });
  }

  Database database;
  std::int64_t bytes_left;
  std::int64_t parts = 0, chunks_of_geometry = 0, frames = 0;
  std::int64_t next_frame = 0, next_chunk = 0;
  Statement record = Prepare(
      "SELECT time, step, size, digest, row_checksum(idx, time, step, size, digest) = checksum FROM frames WHERE idx = "
      "?");
  Statement chunk = Prepare(
      "SELECT bytes, frame = ?2 AND chunk = ?3 AND row_checksum(number, frame, chunk, bytes) = checksum FROM chunks "
      "WHERE number = ?1");
};

JobFileReader::JobFileReader(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}

JobFileReader::~JobFileReader() = default;

std::string JobFileReader::ReadJob() {
  return impl_->ReadAll("SELECT bytes, row_checksum(part, bytes) = checksum FROM job WHERE part = ?", impl_->parts,
                        kMostJob);
}

std::string JobFileReader::ReadGeometry() {
  return impl_->ReadAll("SELECT bytes, row_checksum(chunk, bytes) = checksum FROM geometry WHERE chunk = ?",
                        impl_->chunks_of_geometry, kMostFrame);
}

std::int64_t JobFileReader::frame_count() const { return impl_->frames; }

JobFileReader::StoredFrame JobFileReader::ReadNextFrame() {
  const std::int64_t index = impl_->next_frame++;
  StoredFrame frame{impl_->ReadRecord(index), {}};
  for (std::int64_t chunk = 0; static_cast<std::int64_t>(frame.bytes.size()) < frame.record.size; ++chunk) {
    impl_->Append(impl_->chunk, frame.bytes, frame.record.size, impl_->next_chunk++, index, chunk);
  }
  return frame;
}

}  // namespace fascicle::server
