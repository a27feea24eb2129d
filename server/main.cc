// fascicled: the server program, a thin layer over EmbeddedServer.
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <iostream>
#include <memory>
#include <thread>
#include <variant>

#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_sinks.h>

#include "server/config.h"
#include "server/embedded_server.h"

namespace {

// Blocked in every thread, so that only the main thread receives these signals, in order.
sigset_t BlockStopSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

// Ends the process at a second signal, or if stopping takes too long. The store is consistent at any moment; a worker
// in a long step loses only its work since the last checkpoint.
void WatchOverStop(const sigset_t& signals) {
  std::thread([signals] {
    constexpr timespec kLongest = {9, 0};
    const bool asked_again = sigtimedwait(&signals, nullptr, &kLongest) > 0;
    _exit(asked_again ? EXIT_FAILURE : EXIT_SUCCESS);
  }).detach();
}

// Every client needs a descriptor. gRPC stops accepting for good when there are none left.
void AllowManyFiles() {
  rlimit files;
  if (getrlimit(RLIMIT_NOFILE, &files) != 0) return;
  files.rlim_cur = files.rlim_max;
  setrlimit(RLIMIT_NOFILE, &files);
}

int Serve(const fascicle::server::Config& config, const std::shared_ptr<spdlog::logger>& log) {
  const sigset_t signals = BlockStopSignals();
  std::signal(SIGPIPE, SIG_IGN);
  umask(S_IRWXG | S_IRWXO);  // results belong to the user who runs the server
  AllowManyFiles();
  fascicle::server::ServerOptions options = config.server;
  options.log = log;
  options.record_crashes = true;
  options.niceness = 10;
  if (options.allow_remote)
    log->warn("remote clients are allowed, without TLS or login: use it in trusted networks only");
  const auto server = fascicle::server::EmbeddedServer::Start(options);
  std::cout << "listening on " << server->address() << std::endl;
  int signal = 0;
  sigwait(&signals, &signal);
  WatchOverStop(signals);
  server->Stop();
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  const auto parsed = fascicle::server::ParseArguments(argc, argv, std::cout, std::cerr);
  if (const int* exit_code = std::get_if<int>(&parsed)) return *exit_code;
  const auto& config = std::get<fascicle::server::Config>(parsed);
  setenv("GRPC_VERBOSITY", "NONE", 0);  // fascicle reports relevant errors itself
  auto log = std::make_shared<spdlog::logger>("fascicled", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  log->set_level(config.log_level);
  log->flush_on(spdlog::level::info);
  try {
    return Serve(config, log);
  } catch (const std::exception& e) {
    std::cerr << "fascicled: " << e.what() << std::endl;
    return EXIT_FAILURE;
  }
}
