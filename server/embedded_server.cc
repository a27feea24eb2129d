#include "server/embedded_server.h"

#include <arpa/inet.h>
#include <unistd.h>

#include <algorithm>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_sinks.h>

#include "fascicle/v1/job.pb.h"
#include "server/jobs/crash_marks.h"
#include "server/jobs/job_manager.h"
#include "server/rpc/rpc_server.h"
#include "server/store/result_store.h"
#include "server/store/store.h"
#include "server/translate/job_codec.h"
#include "server/translate/result_cache.h"

namespace fascicle::server {
namespace {

// "HOST" of "HOST:PORT" or "[HOST]:PORT".
std::string HostOf(const std::string& listen) {
  const std::size_t colon = listen.rfind(':');
  const std::string port = colon == std::string::npos ? "" : listen.substr(colon + 1);
  const bool digits = !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
  if (colon == 0 || !digits || std::stoi(port) > 65535) {
    throw std::runtime_error("cannot listen on \"" + listen + "\": it must be HOST:PORT");
  }
  return listen.substr(0, colon);
}

bool IsLoopback(const std::string& host) {
  in_addr address;  // in network order
  if (inet_pton(AF_INET, host.c_str(), &address) == 1) return ntohl(address.s_addr) >> 24 == 127;
  return host == "localhost" || host == "[::1]";
}

std::shared_ptr<spdlog::logger> DefaultLog() {
  auto log = std::make_shared<spdlog::logger>("fascicle", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  log->set_level(spdlog::level::warn);
  return log;
}

std::unique_ptr<Store> OpenStore(const ServerOptions& options) {
  if (options.data_directory.empty()) return MakeMemoryStore();
  try {
    return OpenSqliteStore(options.data_directory, options.least_free_disk);
  } catch (const StoreError& e) {
    throw std::runtime_error("cannot use the data directory " + options.data_directory + ": " + e.what());
  }
}

void LogEvent(spdlog::logger& log, const JobRecord& job, std::string_view event) {
  std::string text = "job " + job.id + " " + std::string(event);
  if (!job.owner.empty()) text += ", owner " + job.owner;
  if (job.attempt > 1) text += ", attempt " + std::to_string(job.attempt);
  if (!job.request_id.empty()) text += ", request " + job.request_id;
  if (v1::Failure failure; job.state == JobState::kFailed && failure.ParseFromString(job.failure)) {
    text += ": " + failure.reason() + ": " + failure.message();
  }
  log.info("{}", text);
}

// 80 % of the machine's memory [byte].
std::int64_t MostMemory() {
  return static_cast<std::int64_t>(0.8 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) *
                                   static_cast<double>(sysconf(_SC_PAGE_SIZE)));
}

JobManagerOptions JobOptions(const ServerOptions& options, const std::shared_ptr<spdlog::logger>& log) {
  JobManagerOptions result = {.workers = options.workers,
                              .default_threads = options.default_threads,
                              .checkpoint_interval = options.checkpoint_interval};
  result.oversubscribe = options.oversubscribe;
  result.max_queued_per_owner = options.max_queued_per_owner;
  result.max_running_per_owner = options.max_running_per_owner;
  result.max_stored_per_owner = options.max_stored_per_owner;
  result.default_ttl_s = options.default_ttl.count();
  result.disk_budget = options.disk_budget;
  result.retention_interval = options.retention_interval;
  result.on_note = [log](const std::string& note) { log->info("{}", note); };
  result.on_event = [log](const JobRecord& job, std::string_view event) { LogEvent(*log, job, event); };
  result.niceness = options.niceness;
  if (!options.record_crashes || options.data_directory.empty()) return result;
  const std::string crashes = options.data_directory + "/crashes";
  result.crashes = TakeCrashes(crashes);
  RecordCrashes(crashes);
  return result;
}

std::unique_ptr<ResultStore> OpenResults(const ServerOptions& options) {
  if (options.data_directory.empty()) return MakeMemoryResults(options.cache_size);
  return OpenResultDirectory(options.data_directory + "/results", options.cache_size);
}

CallLimit AtMost(CallLimit limit, int in_all) { return {in_all, std::min(limit.of_connection, in_all)}; }

Limits LimitsOf(const ServerOptions& options) {
  Limits limits;
  limits.connections = options.connections;
  limits.streams = AtMost(limits.streams, options.streams);
  limits.uploads = AtMost(limits.uploads, options.uploads);
  limits.idle_upload = options.idle_upload;
  limits.silent_connection = options.silent_connection;
  return limits;
}

class Server : public EmbeddedServer {
 public:
  explicit Server(const ServerOptions& options)
      : host_(HostOf(options.listen)),
        log_(options.log ? options.log : DefaultLog()),
        store_(OpenStore(options)),
        result_store_(OpenResults(options)),
        results_(*result_store_),
        jobs_(*store_, MakeJobCodec(&results_), JobOptions(options, log_)),
        rpc_(options.listen, *store_, jobs_, results_, log_, SettingsOf(options)) {
    log_->info("listening on {}, data in {}", address(),
               options.data_directory.empty() ? "memory" : options.data_directory);
  }

  ~Server() override { Stop(); }

  std::string address() const override { return host_ + ":" + std::to_string(rpc_.port()); }
  int port() const override { return rpc_.port(); }

  void Stop() override {
    std::lock_guard lock(stop_mutex_);
    if (std::exchange(stopped_, true)) return;
    log_->info("shutting down");
    rpc_.Stop();  // first, so that no client sees a stalled job
    jobs_.Drain();
    log_->info("stopped");
  }

 private:
  static RpcSettings SettingsOf(const ServerOptions& options) {
    RpcSettings settings;
    settings.workers = options.workers;
    settings.default_threads = options.default_threads;
    settings.max_asset_size = options.max_asset_size;
    settings.oversubscribe = options.oversubscribe;
    settings.max_queued_per_owner = options.max_queued_per_owner;
    settings.max_running_per_owner = options.max_running_per_owner;
    settings.max_stored_per_owner = options.max_stored_per_owner;
    settings.default_ttl_s = options.default_ttl.count();
    settings.disk_budget = options.disk_budget;
    settings.job_memory = options.job_memory > 0 ? options.job_memory : MostMemory();
    settings.limits = LimitsOf(options);
    settings.heartbeat_interval = options.heartbeat_interval;
    settings.progress_interval = options.progress_interval;
    settings.transfer_idle = options.transfer_idle;
    return settings;
  }

  const std::string host_;
  const std::shared_ptr<spdlog::logger> log_;
  const std::unique_ptr<Store> store_;
  const std::unique_ptr<ResultStore> result_store_;
  ResultCache results_;
  JobManager jobs_;
  RpcServer rpc_;
  std::mutex stop_mutex_;
  bool stopped_ = false;
};

}  // namespace

std::unique_ptr<EmbeddedServer> EmbeddedServer::Start(const ServerOptions& options) {
  const std::string host = HostOf(options.listen);
  if (!options.allow_remote && !IsLoopback(host)) {
    throw std::runtime_error("refusing to listen on " + options.listen +
                             ": anyone who can reach this address could run jobs, and nothing is encrypted. "
                             "`fascicled --allow-remote` allows it; 127.0.0.1 is for this machine only");
  }
  if (options.workers < 0 || options.default_threads < 1) {
    throw std::runtime_error("workers must be at least 0, threads at least 1");
  }
  try {
    return std::make_unique<Server>(options);
  } catch (const StoreError& e) {
    throw std::runtime_error(std::string("the storage failed: ") + e.what());
  }
}

}  // namespace fascicle::server
