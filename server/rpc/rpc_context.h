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
#include "server/rpc/connections.h"
#include "server/rpc/errors.h"
#include "server/rpc/executor.h"
#include "server/rpc/limits.h"
#include "server/rpc/open_streams.h"
#include "server/rpc/running_checks.h"
#include "server/rpc/turnstile.h"
#include "server/store/store.h"
#include "server/translate/result_cache.h"

namespace fascicle::server {

// Settings of the services.
struct RpcSettings {
  int workers = 2;
  int default_threads = 1;
  std::int64_t max_asset_size = std::int64_t{4} << 30;                 // [byte]
  std::int64_t job_memory = std::numeric_limits<std::int64_t>::max();  // most memory of a job [byte]
  Limits limits;
  std::chrono::milliseconds heartbeat_interval = std::chrono::seconds(10);         // at most
  std::chrono::milliseconds progress_interval = std::chrono::milliseconds(1'000);  // while a job progresses
};

// Objects shared by all services. Outlives all calls.
struct RpcContext {
  Store& store;
  JobManager& jobs;
  ResultCache& results;
  Executor& kept;       // the calls that have a place when all else is busy
  Executor& quick;      // reads and short writes
  Executor& streaming;  // filling streams
  Executor& slow;       // translation of scenes
  Executor& uploads;    // of assets
  Executor& checks;     // comparing stored jobs with their checksums
  OpenStreams& streams;
  Turnstile& turnstile;
  Connections& connections;
  RunningChecks& running_checks;
  spdlog::logger& log;
  RpcSettings settings;

  // A place for a call, unless the server is being stopped or a limit is reached.
  Connections::Entry Enter(const grpc::CallbackServerContext& call, CallKind kind) const {
    if (streams.draining()) return {nullptr, ShuttingDown()};
    return connections.Enter(call.peer(), kind);
  }
};

// Answers a unary call with `body` (() -> grpc::Status) on an executor. Request and response stay valid until then.
template <class Body>
grpc::ServerUnaryReactor* RunUnary(RpcContext& context, Executor& executor, grpc::CallbackServerContext* call,
                                   const char* method, Body body) {
  grpc::ServerUnaryReactor* reactor = call->DefaultReactor();
  const CallKind kind = &executor == &context.kept ? CallKind::kKept : CallKind::kCall;
  Connections::Entry entry = context.Enter(*call, kind);
  if (!entry.status.ok()) {
    reactor->Finish(entry.status);
    return reactor;
  }
  executor.Post([&context, reactor, place = std::move(entry.place), method, body = std::move(body)] {
    reactor->Finish(Guarded(context.log, method, body));
  });
  return reactor;
}

// The reactor of a call whose stop token is requested when the caller gives up.
class StoppableReactor final : public grpc::ServerUnaryReactor {
 public:
  const std::stop_source& stop() const { return stop_; }
  void OnCancel() override { stop_.request_stop(); }
  void OnDone() override { delete this; }

 private:
  std::stop_source stop_;
};

// Like RunUnary, with a body that takes the stop token of its call: that is requested when the caller gives up, and
// after the longest time allowed.
template <class Body>
grpc::ServerUnaryReactor* RunStoppable(RpcContext& context, Executor& executor, grpc::CallbackServerContext* call,
                                       const char* method, Body body) {
  auto* reactor = new StoppableReactor;
  Connections::Entry entry = context.Enter(*call, CallKind::kSubmission);
  if (!entry.status.ok()) {
    reactor->Finish(entry.status);
    return reactor;
  }
  executor.Post(
      [&context, reactor, place = std::move(entry.place), stop = reactor->stop(), method, body = std::move(body)] {
        const RunningChecks::Watch watch(context.running_checks, stop, context.settings.limits.longest_check);
        const grpc::Status status = Guarded(context.log, method, [&] { return body(stop.get_token()); });
        reactor->Finish(watch.expired() ? TookTooLong(context.settings.limits.longest_check) : status);
      });
  return reactor;
}

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_RPC_CONTEXT_H_
