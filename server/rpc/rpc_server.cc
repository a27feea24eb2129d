#include "server/rpc/rpc_server.h"

#include <sys/resource.h>

#include <algorithm>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>

#include <grpc/grpc.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include "server/rpc/asset_service.h"
#include "server/rpc/call_watch.h"
#include "server/rpc/frame_service.h"
#include "server/rpc/job_service.h"
#include "server/rpc/listener.h"
#include "server/rpc/log_service.h"
#include "server/rpc/memory_trim.h"
#include "server/rpc/server_service.h"
#include "server/rpc/steering_service.h"
#include "server/rpc/transfer_service.h"

namespace fascicle::server {
namespace {

constexpr int kFilesOfServer = 128;       // file descriptors for other things than connections
constexpr int kLargestMessage = 4 << 20;  // [byte]; frames and files are sent in chunks of 1 MiB
constexpr int kConcurrentStreams = 256;   // per connection
constexpr int kKeepaliveTime = 30'000;    // [ms]
// [ms]; long enough for a client that computes or draws for some seconds between two reads.
constexpr int kKeepaliveTimeout = 20'000;
constexpr int kShortestPingInterval = 10'000;  // [ms]
constexpr int kLongestIdle = 600'000;          // [ms]; connections without a call for longer are closed

constexpr int kKeptThreads = 2;
constexpr int kQuickThreads = 2;
constexpr int kStreamingThreads = 4;
constexpr int kStreamingNiceness = 5;  // small answers first
constexpr int kSlowThreads = 2;
constexpr int kCommitThreads = 32;
constexpr int kUploadThreads = 2;
constexpr int kCheckThreads = 1;

// The settings with as many connections as there are file descriptors for: each needs two.
RpcSettings Fitting(RpcSettings settings) {
  rlimit files;
  if (getrlimit(RLIMIT_NOFILE, &files) != 0 || files.rlim_cur == RLIM_INFINITY) return settings;
  const auto most = (static_cast<std::int64_t>(files.rlim_cur) - kFilesOfServer) / 2;
  settings.limits.connections = static_cast<int>(std::clamp<std::int64_t>(most, 1, settings.limits.connections));
  return settings;
}

void Configure(grpc::ServerBuilder& builder) {
  builder.SetMaxReceiveMessageSize(kLargestMessage);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kConcurrentStreams);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveTime);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeout);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, kShortestPingInterval);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_IDLE_MS, kLongestIdle);
}

// gRPC 1.51 stops its threads with its last object, and sometimes waits ten seconds for one that polls. Keeping the
// library initialized until the process ends avoids that.
void KeepLibraryUp() { [[maybe_unused]] static const bool kept = (grpc_init(), true); }

}  // namespace

struct RpcServer::Impl {
  Impl(Store& store, JobManager& jobs, ResultCache& results, std::shared_ptr<spdlog::logger> log,
       const RpcSettings& settings)
      : logger(std::move(log)),
        connections(Fitting(settings).limits, *logger),
        context{store,   jobs,   results, kept,      quick,       streaming,      slow,    commits,
                uploads, checks, streams, turnstile, connections, running_checks, *logger, Fitting(settings)} {}

  // Every second: reports whether jobs can be accepted (while the store has a problem, only what is stored is served),
  // stops checks that take too long, and returns memory.
  void Watch() {
    const std::lock_guard lock(watch_mutex);
    if (stopped) return;
    const std::string problem = context.store.Problem();
    if (problem != last_problem) {
      if (problem.empty()) logger->info("the store is well again");
      if (!problem.empty()) logger->error("jobs wait: {}", problem);
      grpc::HealthCheckServiceInterface* health = server->GetHealthCheckService();
      for (const char* service : {v1::JobService::service_full_name(), v1::AssetService::service_full_name()}) {
        health->SetServingStatus(service, problem.empty());
      }
      last_problem = problem;
    }
    running_checks.StopExpired();
    frame_service.DropUnused();
    memory.Look();
    kept.PostAfter(std::chrono::seconds(1), [this] { Watch(); });
  }

  std::shared_ptr<spdlog::logger> logger;
  std::mutex watch_mutex;  // guards stopped, last_problem and memory
  std::string last_problem;
  MemoryTrim memory;
  OpenStreams streams;
  Connections connections;
  RunningChecks running_checks;
  RpcContext context;
  JobServiceImpl job_service{context};
  AssetServiceImpl asset_service{context};
  FrameServiceImpl frame_service{context};
  ServerServiceImpl server_service{context};
  TransferServiceImpl transfer_service{context};
  SteeringServiceImpl steering_service{context};
  LogServiceImpl log_service{context};
  grpc::CallbackGenericService other_methods;  // refuses them
  Turnstile turnstile{streaming, 2 * std::max(1u, std::thread::hardware_concurrency())};
  // Destroyed in reverse order: every call ends, then the last tasks of the executors, then the objects they use.
  const Executor::OnError on_error = [this](const std::string& what) { logger->error("executor: {}", what); };
  Executor kept{kKeptThreads, on_error};
  Executor quick{kQuickThreads, on_error};
  Executor streaming{kStreamingThreads, on_error, kStreamingNiceness};
  Executor commits{kCommitThreads, on_error};
  Executor slow{kSlowThreads, on_error};  // before those to which it posts
  Executor uploads{kUploadThreads, on_error};
  Executor checks{kCheckThreads, on_error};
  std::unique_ptr<Listener> listener;
  std::unique_ptr<grpc::Server> server;
  bool stopped = false;
};

RpcServer::RpcServer(const std::string& listen, Store& store, JobManager& jobs, ResultCache& results,
                     std::shared_ptr<spdlog::logger> log, const RpcSettings& settings)
    : impl_(std::make_unique<Impl>(store, jobs, results, std::move(log), settings)) {
  KeepLibraryUp();
  // Both are settings of the whole process; enabling them twice has no effect.
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  impl_->listener = std::make_unique<Listener>(listen);
  grpc::ServerBuilder builder;
  Configure(builder);
  builder.experimental().SetInterceptorCreators(WatchCalls(impl_->connections));
  builder.RegisterCallbackGenericService(&impl_->other_methods);
  builder.RegisterService(&impl_->job_service);
  builder.RegisterService(&impl_->asset_service);
  builder.RegisterService(&impl_->frame_service);
  builder.RegisterService(&impl_->server_service);
  builder.RegisterService(&impl_->transfer_service);
  builder.RegisterService(&impl_->steering_service);
  builder.RegisterService(&impl_->log_service);
  impl_->server = builder.BuildAndStart();
  if (!impl_->server) throw std::runtime_error("gRPC cannot start");
  grpc::HealthCheckServiceInterface* health = impl_->server->GetHealthCheckService();
  for (const char* service : {v1::JobService::service_full_name(), v1::AssetService::service_full_name(),
                              v1::FrameService::service_full_name(), v1::ServerService::service_full_name(),
                              v1::TransferService::service_full_name(), v1::SteeringService::service_full_name(),
                              v1::LogService::service_full_name()}) {
    health->SetServingStatus(service, true);
  }
  impl_->listener->Start(*impl_->server, impl_->connections, *impl_->logger);
  impl_->kept.Post([impl = impl_.get()] { impl->Watch(); });
}

RpcServer::~RpcServer() { Stop(); }

int RpcServer::port() const { return impl_->listener->port(); }

void RpcServer::Stop() {
  {
    const std::lock_guard lock(impl_->watch_mutex);
    if (std::exchange(impl_->stopped, true) || !impl_->server) return;
  }
  impl_->server->GetHealthCheckService()->SetServingStatus(false);
  impl_->streams.Drain();
  impl_->streams.WaitUntilEmpty(std::chrono::seconds(2));
  impl_->listener->Stop();
  // Cuts the remaining calls (a reader that has stopped reading, a health watch).
  impl_->server->Shutdown(std::chrono::system_clock::now() + std::chrono::seconds(1));
}

}  // namespace fascicle::server
