#include "server/config.h"

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <ostream>
#include <string>

#include <CLI/CLI.hpp>

namespace fascicle::server {
namespace {

// As in the XDG base directory specification; empty if there is no home directory.
std::string DefaultDataDirectory() {
  const char* data_home = std::getenv("XDG_DATA_HOME");
  if (data_home != nullptr && data_home[0] == '/') return std::string(data_home) + "/fascicle";
  const char* home = std::getenv("HOME");
  return home != nullptr && home[0] != '\0' ? std::string(home) + "/.local/share/fascicle" : "";
}

constexpr const char* kFooter = R"(
Examples:
  fascicled                                    serve this machine on port 7300
  fascicled --listen 127.0.0.1:0               choose a free port and print it
  fascicled --data /srv/fascicle --workers 4   four jobs at once, data in /srv/fascicle
  fascicled --ttl 30d --disk-budget 200GB      remove jobs after 30 days, and old frames beyond 200 GB
  fascicled --listen 0.0.0.0:7300 --allow-remote
                                               allow other machines, in trusted networks only

It prints `listening on HOST:PORT` when it is ready. SIGTERM or SIGINT stop it; running jobs store a
checkpoint and continue with the next start. A second signal ends it at once.
Exit codes: 0 stopped, 1 could not start, 2 invalid options.)";

}  // namespace

std::variant<Config, int> ParseArguments(int argc, const char* const* argv, std::ostream& out, std::ostream& err) {
  Config config;
  config.server.listen = "127.0.0.1:7300";
  config.server.data_directory = DefaultDataDirectory();
  config.server.max_queued_per_owner = 10'000;
  std::string level = "info";
  double checkpoint = 2;
  std::int64_t ttl = 0;

  CLI::App app("fascicled runs simulations of muscle and soft tissue for clients.", "fascicled");
  app.footer(kFooter);
  app.set_version_flag("--version", std::string("fascicled ") + FASCICLE_VERSION);
  app.add_option("--listen", config.server.listen, "Address to listen on")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  app.add_option("--data", config.server.data_directory, "Folder for jobs, frames and assets; on a local disk")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_option("--workers", config.server.workers, "Jobs that run at the same time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--threads", config.server.default_threads, "Threads of a job that does not ask for a number")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--cache", config.server.cache_size,
                 "Disk space for results that take long, such as segmented images and fibres, and that later jobs can "
                 "use again; 0 for none")
      ->type_name("SIZE")
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::NonNegativeNumber)
      ->default_str("2GiB");
  app.add_option("--job-memory", config.server.job_memory,
                 "Most memory of a job; larger ones are refused by an estimate")
      ->type_name("SIZE")
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::PositiveNumber)
      ->default_str("80 % of the machine's");
  app.add_option("--keep-free", config.server.least_free_disk,
                 "Free disk space below which jobs wait and new ones are refused")
      ->type_name("SIZE")
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::NonNegativeNumber)
      ->default_str("2 % of the disk, from 4MiB to 1GiB");
  app.add_option("--connections", config.server.connections, "Clients that can be connected at the same time")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app.add_option("--streams", config.server.streams, "Streams of frames at the same time")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app.add_option("--uploads", config.server.uploads, "Uploads at the same time")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  app.add_option("--checkpoint", checkpoint, "Most work of a job that a crash can lose")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.01, 3600.0))
      ->capture_default_str();
  app.add_flag("--oversubscribe", config.server.oversubscribe,
               "Give jobs the threads that they ask for, even if all jobs together then have more threads than cores");
  app.add_option("--owner-queued", config.server.max_queued_per_owner,
                 "Most jobs of an owner in the queue; 0: no limit")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app.add_option("--owner-running", config.server.max_running_per_owner,
                 "Most jobs of an owner that run at once; 0: no limit")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  app.add_option("--owner-stored", config.server.max_stored_per_owner,
                 "Most that is stored of an owner's jobs before new ones are refused; 0: no limit")
      ->type_name("SIZE")
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--ttl", ttl, "How long jobs are kept after their end, unless they are pinned; 0: for ever")
      ->type_name("TIME")
      ->transform(
          CLI::AsNumberWithUnit(std::map<std::string, std::int64_t>{{"s", 1}, {"m", 60}, {"h", 3600}, {"d", 86400}},
                                CLI::AsNumberWithUnit::CASE_SENSITIVE))
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{315'576'000}))
      ->capture_default_str();
  app.add_option("--disk-budget", config.server.disk_budget,
                 "Disk space for frames: beyond it, frames of the finished jobs that ended first are removed, unless "
                 "they are pinned; 0: no limit")
      ->type_name("SIZE")
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_flag("--allow-remote", config.server.allow_remote,
               "Allow addresses other than loopback; there is no TLS and no login");
  app.add_option("--log-level", level, "What is logged to stderr")
      ->check(CLI::IsMember({"debug", "info", "warn", "error", "off"}))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e, out, err) == 0 ? 0 : 2;
  }
  if (config.server.data_directory.empty()) {
    err << "fascicled: there is no home directory: choose a data directory with --data\n";
    return 2;
  }
  config.server.checkpoint_interval = std::chrono::milliseconds(static_cast<int>(1000 * checkpoint));
  config.server.default_ttl = std::chrono::seconds(ttl);
  config.log_level = spdlog::level::from_str(level);
  return config;
}

}  // namespace fascicle::server
