#include "server/store/database.h"

#include <sqlite3.h>

#include <filesystem>
#include <utility>

#include "server/store/file_system.h"
#include "server/store/row_checksum.h"
#include "server/store/store.h"

namespace fascicle::server {
namespace {

constexpr int kBusyTimeoutMs = 10'000;

// Throws the error of `code`, an extended result code.
[[noreturn]] void ThrowError(int code, const std::string& what) {
  switch (code & 0xFF) {
    case SQLITE_FULL:
      throw NoSpaceError(what);
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      throw DamageError(what);
    default:
      throw StoreError(what);
  }
}

[[noreturn]] void Throw(sqlite3* handle, const std::string& doing) {
  const char* path = sqlite3_db_filename(handle, "main");
  ThrowError(sqlite3_extended_errcode(handle),
             std::string(path != nullptr ? path : "database") + ": " + sqlite3_errmsg(handle) + " (" + doing + ")");
}

void Check(int code, sqlite3* handle, const char* doing) {
  if (code != SQLITE_OK) Throw(handle, doing);
}

void Check(int code, sqlite3_stmt* statement) {
  if (code != SQLITE_OK) Throw(sqlite3_db_handle(statement), "bind");
}

// Lets nothing in a file run, and bounds what reading it may cost.
void Restrict(sqlite3* handle) {
  struct Setting {
    int name;
    int value;
  };
  for (const Setting& setting :
       {Setting{SQLITE_DBCONFIG_DEFENSIVE, 1}, Setting{SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
        Setting{SQLITE_DBCONFIG_ENABLE_TRIGGER, 0}, Setting{SQLITE_DBCONFIG_ENABLE_VIEW, 0},
        Setting{SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION, 0}, Setting{SQLITE_DBCONFIG_WRITABLE_SCHEMA, 0}}) {
    Check(sqlite3_db_config(handle, setting.name, setting.value, nullptr), handle, "restrict");
  }
  for (const Setting& limit :
       {Setting{SQLITE_LIMIT_LENGTH, 2 << 20}, Setting{SQLITE_LIMIT_SQL_LENGTH, 4096}, Setting{SQLITE_LIMIT_COLUMN, 32},
        Setting{SQLITE_LIMIT_EXPR_DEPTH, 32}, Setting{SQLITE_LIMIT_ATTACHED, 0}, Setting{SQLITE_LIMIT_TRIGGER_DEPTH, 0},
        Setting{SQLITE_LIMIT_VDBE_OP, 10'000}}) {
    sqlite3_limit(handle, limit.name, limit.value);
  }
  // A look-up by key takes some dozens of operations, an entry of the schema about ten.
  constexpr int kMostOperations = 2000;
  sqlite3_progress_handler(
      handle, kMostOperations, [](void*) { return 1; }, nullptr);
  Check(sqlite3_exec(handle, "PRAGMA cell_size_check = ON; PRAGMA mmap_size = 0", nullptr, nullptr, nullptr), handle,
        "restrict");
}

}  // namespace

Rows::~Rows() {
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
}

bool Rows::Next() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) Throw(sqlite3_db_handle(statement_), sqlite3_sql(statement_));
  return false;
}

std::int64_t Rows::Int(int column) const { return sqlite3_column_int64(statement_, column); }

double Rows::Real(int column) const { return sqlite3_column_double(statement_, column); }

std::string_view Rows::Bytes(int column) const {
  // The order matters: reading the bytes may convert them, and the size is right only afterwards.
  const void* bytes = sqlite3_column_blob(statement_, column);
  if (bytes == nullptr) return {};
  return {static_cast<const char*>(bytes), static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

Statement::Statement(Statement&& other) noexcept : statement_(std::exchange(other.statement_, nullptr)) {}

Statement::~Statement() { sqlite3_finalize(statement_); }

void Statement::Bind(int index, std::int64_t value) { Check(sqlite3_bind_int64(statement_, index, value), statement_); }

void Statement::Bind(int index, double value) { Check(sqlite3_bind_double(statement_, index, value), statement_); }

void Statement::Bind(int index, std::string_view text) {
  const char* begin = text.data() == nullptr ? "" : text.data();  // a null pointer would bind NULL
  Check(sqlite3_bind_text64(statement_, index, begin, text.size(), SQLITE_STATIC, SQLITE_UTF8), statement_);
}

void Statement::Bind(int index, Blob blob) {
  const char* begin = blob.bytes.data() == nullptr ? "" : blob.bytes.data();
  Check(sqlite3_bind_blob64(statement_, index, begin, blob.bytes.size(), SQLITE_STATIC), statement_);
}

void Statement::Bind(int index, std::nullptr_t) { Check(sqlite3_bind_null(statement_, index), statement_); }

Database::Database(const std::string& path, Mode mode) : path_(path) {
  int flags = SQLITE_OPEN_NOMUTEX | (mode == Mode::kUntrusted ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE);
  if (mode == Mode::kCreate) flags |= SQLITE_OPEN_CREATE;
  const int code = sqlite3_open_v2(path.c_str(), &handle_, flags, nullptr);
  if (code != SQLITE_OK) {
    sqlite3_close(std::exchange(handle_, nullptr));
    ThrowError(code, path + ": cannot be opened: " + sqlite3_errstr(code));
  }
  sqlite3_extended_result_codes(handle_, 1);
  sqlite3_busy_timeout(handle_, kBusyTimeoutMs);
  try {
    if (mode == Mode::kUntrusted) Restrict(handle_);
    AddRowChecksum(handle_);
    Execute("PRAGMA foreign_keys = ON");
    if (mode == Mode::kReadOnly) Execute("PRAGMA query_only = ON");
  } catch (...) {
    sqlite3_close(handle_);
    throw;
  }
}

Database::Database(Database&& other) noexcept
    : path_(std::move(other.path_)), handle_(std::exchange(other.handle_, nullptr)) {}

Database::~Database() { sqlite3_close_v2(handle_); }

void Database::Execute(const char* sql) { Check(sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr), handle_, sql); }

std::int64_t Database::QueryInt(const char* sql) {
  Statement statement = Prepare(sql);
  Rows rows = statement.Query();
  return rows.Next() ? rows.Int(0) : 0;
}

Statement Database::Prepare(std::string_view sql) {
  sqlite3_stmt* statement = nullptr;
  Check(sqlite3_prepare_v3(handle_, sql.data(), static_cast<int>(sql.size()), SQLITE_PREPARE_PERSISTENT, &statement,
                           nullptr),
        handle_, "prepare");
  return Statement(statement);
}

std::int64_t Database::changes() const { return sqlite3_changes64(handle_); }

Transaction::Transaction(Database& database) : database_(database) { database_.Execute("BEGIN IMMEDIATE"); }

Transaction::~Transaction() {
  // After some errors SQLite has already rolled back. If this fails, nothing more can be done.
  if (sqlite3_get_autocommit(database_.handle_) == 0)
    sqlite3_exec(database_.handle_, "ROLLBACK", nullptr, nullptr, nullptr);
}

void Transaction::Commit() { database_.Execute("COMMIT"); }

namespace {

void BackUp(Database& database, std::int64_t format) {
  const std::string backup = database.path() + ".format-" + std::to_string(format) + ".backup";
  std::filesystem::remove(backup);  // of an interrupted upgrade
  Statement copy = database.Prepare("VACUUM INTO ?");
  copy.Run(std::string_view(backup));
  SyncFile(backup);
  SyncParent(backup);
}

void CheckOrigin(Database& database, int application_id, std::int64_t newest) {
  const std::int64_t format = database.QueryInt("PRAGMA user_version");
  const std::int64_t application = database.QueryInt("PRAGMA application_id");
  const bool empty = format == 0 && application == 0 && database.QueryInt("SELECT count(*) FROM sqlite_schema") == 0;
  if (!empty && application != application_id) throw StoreError(database.path() + ": is not a file of this kind");
  if (format > newest) {
    throw StoreError(database.path() + ": has format " + std::to_string(format) +
                     ", written by a newer version; this one knows " + std::to_string(newest));
  }
}

void Upgrade(Database& database, int application_id, std::span<const char* const> formats) {
  const std::int64_t newest = static_cast<std::int64_t>(formats.size());
  const std::int64_t format = database.QueryInt("PRAGMA user_version");
  if (format == newest) return;
  if (format > 0) BackUp(database, format);
  Transaction transaction(database);
  for (std::int64_t i = format; i < newest; ++i) database.Execute(formats[static_cast<std::size_t>(i)]);
  database.Execute(("PRAGMA application_id = " + std::to_string(application_id)).c_str());
  database.Execute(("PRAGMA user_version = " + std::to_string(newest)).c_str());
  transaction.Commit();
}

}  // namespace

Database OpenFormatted(const std::string& path, int application_id, std::span<const char* const> formats,
                       int page_size) {
  const bool is_new = !std::filesystem::exists(path);
  Database database(path, Database::Mode::kCreate);
  CheckOrigin(database, application_id, static_cast<std::int64_t>(formats.size()));
  database.Execute(("PRAGMA page_size = " + std::to_string(page_size)).c_str());  // for a new file
  database.Execute("PRAGMA journal_mode = WAL");
  database.Execute("PRAGMA synchronous = FULL");
  database.Execute("PRAGMA journal_size_limit = 67108864");
  Upgrade(database, application_id, formats);
  if (is_new) SyncParent(path);
  return database;
}

}  // namespace fascicle::server
