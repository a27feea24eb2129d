#ifndef FASCICLE_SERVER_EMBEDDED_SERVER_H_
#define FASCICLE_SERVER_EMBEDDED_SERVER_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

namespace spdlog {
class logger;
}

namespace fascicle::server {

struct ServerOptions {
  std::string listen = "127.0.0.1:0";  // port 0 picks a free one
  std::string data_directory;          // empty: in memory
  int workers = 2;                     // 0: jobs stay in the queue, for a server that only reads
  int default_threads = 1;
  bool oversubscribe = false;  // whether jobs get all threads that they ask for, whatever else runs
  // Limits of an owner's jobs; 0: none.
  int max_queued_per_owner = 0;
  int max_running_per_owner = 0;
  std::int64_t max_stored_per_owner = 0;  // [byte]
  // What is kept; 0: everything.
  std::chrono::seconds default_ttl = std::chrono::seconds(0);               // of jobs after their end
  std::int64_t disk_budget = 0;                                             // for frames and geometry [byte]
  std::chrono::milliseconds retention_interval = std::chrono::seconds(10);  // between looks for what can be removed
  int niceness = 0;  // of the threads that run jobs, beyond that of the process: others are answered sooner then
  bool record_crashes = false;  // in the data directory, for the next start; changes signal handlers of the process
  bool allow_remote = false;    // whether addresses other than loopback are allowed

  std::int64_t max_asset_size = std::int64_t{4} << 30;  // [byte]
  std::int64_t job_memory =
      0;  // most memory of a job, estimated before it is accepted [byte]; 0: 80 % of the machine's
  std::int64_t least_free_disk = -1;  // free disk space below which jobs wait [byte]; negative: 2 % of the disk
  std::int64_t cache_size = std::int64_t{2} << 30;  // of results kept for reuse [byte]
  int connections = 1000;  // of clients at once; fewer if the process may not open twice as many files
  int streams = 2000;      // of frames and geometries at once
  int uploads = 64;        // at once
  std::chrono::milliseconds idle_upload = std::chrono::seconds(60);                // an idle upload ends after this
  std::chrono::milliseconds silent_connection = std::chrono::seconds(30);          // one that makes no call, too
  std::chrono::milliseconds checkpoint_interval = std::chrono::seconds(2);         // of running jobs
  std::chrono::milliseconds heartbeat_interval = std::chrono::seconds(10);         // of frame streams, at most
  std::chrono::milliseconds progress_interval = std::chrono::milliseconds(1'000);  // the same while a job progresses
  std::chrono::milliseconds transfer_idle = std::chrono::seconds(60);              // of exports and imports, at most
  std::shared_ptr<spdlog::logger> log;  // null: warnings and errors to stderr
};

// A complete server within this process. `fascicled` and `fascicle run` are thin layers over it.
class EmbeddedServer {
 public:
  // Returns when the server is listening. Throws std::runtime_error with a message for users.
  static std::unique_ptr<EmbeddedServer> Start(const ServerOptions& options);
  virtual ~EmbeddedServer() = default;
  virtual std::string address() const = 0;  // "127.0.0.1:PORT"
  virtual int port() const = 0;
  // Drains: ends every stream with UNAVAILABLE, stops workers with a checkpoint, closes. Idempotent; takes at most 10
  // s.
  virtual void Stop() = 0;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_EMBEDDED_SERVER_H_
