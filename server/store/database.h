#ifndef FASCICLE_SERVER_STORE_DATABASE_H_
#define FASCICLE_SERVER_STORE_DATABASE_H_

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace fascicle::server {

// A thin layer over SQLite's C interface: owned handles, typed arguments, and every error thrown as a StoreError
// (DamageError, NoSpaceError) that names the file. A connection and its statements belong to one thread at a time.

// Bytes, as opposed to std::string_view for text.
struct Blob {
  std::string_view bytes;
};

// The rows of a running query. Values are valid until the next call of Next. The destructor resets the statement and
// ends its read transaction.
class Rows {
 public:
  explicit Rows(sqlite3_stmt* statement) : statement_(statement) {}
  ~Rows();
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;

  // False after the last row.
  bool Next();
  // Columns are counted from 0.
  std::int64_t Int(int column) const;
  double Real(int column) const;
  std::string_view Bytes(int column) const;  // of text or a blob; empty for NULL
  std::string String(int column) const { return std::string(Bytes(column)); }

 private:
  sqlite3_stmt* statement_;
};

class Statement {
 public:
  Statement(Statement&& other) noexcept;
  Statement& operator=(Statement&&) = delete;
  ~Statement();

  // Binds the arguments in order and starts the query. Text and blobs are not copied; they must outlive the rows.
  template <class... Args>
  Rows Query(const Args&... args) {
    int index = 0;
    (Bind(++index, args), ...);
    return Rows(statement_);
  }
  // Runs a statement without rows.
  template <class... Args>
  void Run(const Args&... args) {
    Query(args...).Next();
  }
  // Binds one argument, counted from 1, for a Query without arguments.
  void Bind(int index, std::int64_t value);
  void Bind(int index, int value) { Bind(index, std::int64_t{value}); }
  void Bind(int index, double value);
  void Bind(int index, std::string_view text);
  void Bind(int index, Blob blob);
  void Bind(int index, std::nullptr_t);
  // NULL if there is none.
  template <class Value>
  void Bind(int index, const std::optional<Value>& value) {
    if (value) {
      Bind(index, *value);
    } else {
      Bind(index, nullptr);
    }
  }

 private:
  friend class Database;
  explicit Statement(sqlite3_stmt* statement) : statement_(statement) {}

  sqlite3_stmt* statement_;
};

class Database {
 public:
  enum class Mode { kCreate, kReadWrite, kReadOnly, kUntrusted };

  // kReadOnly still opens the file for writing, as a WAL requires, but refuses all changes. kUntrusted is for files
  // from anyone: they are not written; views, triggers, functions and extensions named in them do not run; schemas of
  // more than some hundred entries and rows of more than 2 MiB are errors, and so are statements of many operations.
  Database(const std::string& path, Mode mode);
  Database(Database&& other) noexcept;
  Database& operator=(Database&&) = delete;
  ~Database();

  // Runs one or more statements without arguments and results.
  void Execute(const char* sql);
  // First value of the first row of a query, as in `PRAGMA user_version`.
  std::int64_t QueryInt(const char* sql);
  Statement Prepare(std::string_view sql);
  // Number of rows changed by the last INSERT, UPDATE or DELETE.
  std::int64_t changes() const;
  const std::string& path() const { return path_; }

 private:
  friend class Transaction;
  std::string path_;
  sqlite3* handle_ = nullptr;
};

// BEGIN IMMEDIATE ... COMMIT; rolled back if destroyed before Commit.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void Commit();

 private:
  Database& database_;
};

// Opens a database for writing, creates it if it does not exist, and upgrades it to the newest format: `formats[i]` is
// the SQL that converts format i to format i + 1, where format 0 is an empty file. Before an upgrade a copy is saved as
// PATH.format-N.backup. Durable: WAL with synchronous FULL. Throws StoreError if the file has a newer format or belongs
// to another application.
Database OpenFormatted(const std::string& path, int application_id, std::span<const char* const> formats,
                       int page_size = 4096);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_STORE_DATABASE_H_
