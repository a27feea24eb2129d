#ifndef FASCICLE_SERVER_RPC_RPC_CONTEXT_H_
#define FASCICLE_SERVER_RPC_RPC_CONTEXT_H_

#include <chrono>
#include <cstdint>
#include <limits>
#include <stop_token>
#include <utility>

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>
#include <spdlog/logger.h>

#include "server/jobs/job_manager.h"
#include "server/rpc/errors.h"
#include "server/rpc/executor.h"
#include "server/rpc/open_streams.h"
#include "server/store/store.h"
#include "server/translate/result_cache.h"

namespace fascicle::server {

// Settings of the services.
struct RpcSettings {
  int workers = 2;
  int default_threads = 1;
  std::int64_t max_asset_size = std::int64_t{4} << 30;                 // [byte]
  std::int64_t job_memory = std::numeric_limits<std::int64_t>::max();  // most memory of a job [byte]
  // Limits of owners and what is kept, as in JobManagerOptions.
  bool oversubscribe = false;
  int max_queued_per_owner = 0;
  int max_running_per_owner = 0;
  std::int64_t max_stored_per_owner = 0;  // [byte]
  std::int64_t default_ttl_s = 0;
  std::int64_t disk_budget = 0;                                                    // [byte]
  std::chrono::milliseconds heartbeat_interval = std::chrono::seconds(10);         // at most
  std::chrono::milliseconds progress_interval = std::chrono::milliseconds(1'000);  // while a job progresses
  std::chrono::milliseconds transfer_idle = std::chrono::seconds(60);  // exports and imports end that pause for longer
};

// Objects shared by all services. Outlives all calls.
struct RpcContext {
  Store& store;
  JobManager& jobs;
  ResultCache& results;
  Executor& quick;    // reads and short writes
  Executor& slow;     // translation of scenes, uploads
  Executor& commits;  // storing new jobs: many threads that wait for the disk together
  OpenStreams& streams;
  spdlog::logger& log;
  RpcSettings settings;
};

// Answers a unary call with `body` (() -> grpc::Status) on an executor. Request and response stay valid until then.
template <class Body>
grpc::ServerUnaryReactor* RunUnary(RpcContext& context, Executor& executor, grpc::CallbackServerContext* call,
                                   const char* method, Body body) {
  grpc::ServerUnaryReactor* reactor = call->DefaultReactor();
  if (context.streams.draining()) {
    reactor->Finish(ShuttingDown());
    return reactor;
  }
  executor.Post(
      [&context, reactor, method, body = std::move(body)] { reactor->Finish(Guarded(context.log, method, body)); });
  return reactor;
}

// The reactor of a call whose stop token is requested when the caller gives up.
class StoppableReactor final : public grpc::ServerUnaryReactor {
 public:
  std::stop_token stop() const { return stop_.get_token(); }
  void OnCancel() override { stop_.request_stop(); }
  void OnDone() override { delete this; }

 private:
  std::stop_source stop_;
};

// Like RunUnary, with a body that takes the stop token of its call.
template <class Body>
grpc::ServerUnaryReactor* RunStoppable(RpcContext& context, Executor& executor, const char* method, Body body) {
  auto* reactor = new StoppableReactor;
  if (context.streams.draining()) {
    reactor->Finish(ShuttingDown());
    return reactor;
  }
  executor.Post([&context, reactor, stop = reactor->stop(), method, body = std::move(body)] {
    reactor->Finish(Guarded(context.log, method, [&] { return body(stop); }));
  });
  return reactor;
}

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_RPC_CONTEXT_H_
