#ifndef FASCICLE_TESTS_BENCH_RAW_SQLITE_H_
#define FASCICLE_TESTS_BENCH_RAW_SQLITE_H_

#include <sqlite3.h>

#include <cstdlib>
#include <string>

namespace fascicle::bench {

// Plain SQLite commits of the durability of the store: WAL, synchronous FULL, one row and one commit each, one
// connection.
class RawSqlite {
 public:
  explicit RawSqlite(const std::string& path) {
    sqlite3_open(path.c_str(), &database_);
    Run("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;"
        "CREATE TABLE jobs (id TEXT PRIMARY KEY, request_id TEXT UNIQUE, spec BLOB)");
    sqlite3_prepare_v2(database_, "INSERT INTO jobs VALUES (?, ?, ?)", -1, &insert_, nullptr);
  }
  ~RawSqlite() {
    sqlite3_finalize(insert_);
    sqlite3_close(database_);
  }

  void Insert(const std::string& id, const std::string& request_id, const std::string& spec) {
    sqlite3_bind_text(insert_, 1, id.data(), static_cast<int>(id.size()), SQLITE_STATIC);
    sqlite3_bind_text(insert_, 2, request_id.data(), static_cast<int>(request_id.size()), SQLITE_STATIC);
    sqlite3_bind_blob(insert_, 3, spec.data(), static_cast<int>(spec.size()), SQLITE_STATIC);
    if (sqlite3_step(insert_) != SQLITE_DONE) std::abort();
    sqlite3_reset(insert_);
  }

 private:
  void Run(const char* sql) {
    if (sqlite3_exec(database_, sql, nullptr, nullptr, nullptr) != SQLITE_OK) std::abort();
  }

  sqlite3* database_ = nullptr;
  sqlite3_stmt* insert_ = nullptr;
};

}  // namespace fascicle::bench

#endif  // FASCICLE_TESTS_BENCH_RAW_SQLITE_H_
