#include "client/lib/connection.h"

#include <grpc/grpc.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include "client/lib/backoff.h"
#include "client/lib/status_error.h"

namespace fascicle::client {
namespace {

using Clock = std::chrono::system_clock;  // the clock of gRPC's deadlines

constexpr int kDetailsLimit = 256 << 10;  // [byte]

std::shared_ptr<grpc::Channel> MakeChannel(const std::string& address) {
  // gRPC 1.51 stops its threads with its last object, and sometimes waits ten seconds for one that polls. Keeping the
  // library initialized until the process ends avoids that.
  [[maybe_unused]] static const bool kept = (grpc_init(), true);
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(16 << 20);  // a job with its scene is the largest response
  arguments.SetInt(GRPC_ARG_MAX_METADATA_SIZE, 2 * kDetailsLimit);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 5000);  // limit for connecting
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 1000);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, 30'000);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 20'000);
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // no backoff shared with other clients
  return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

}  // namespace

void PrepareCall(grpc::ClientContext& context) {
  context.AddMetadata("fascicle-details-limit", std::to_string(kDetailsLimit));
}

Connection::Connection(const std::string& address)
    : address_(address),
      channel_(MakeChannel(address)),
      jobs_(v1::JobService::NewStub(channel_)),
      assets_(v1::AssetService::NewStub(channel_)),
      frames_(v1::FrameService::NewStub(channel_)),
      server_(v1::ServerService::NewStub(channel_)),
      transfers_(v1::TransferService::NewStub(channel_)),
      steering_(v1::SteeringService::NewStub(channel_)),
      logs_(v1::LogService::NewStub(channel_)) {}

grpc::Status Connection::Connect() {
  if (connected_) return grpc::Status::OK;
  const Clock::time_point start = Clock::now();
  const Clock::time_point refused_until = start + std::chrono::seconds(2);
  Clock::time_point deadline = start + std::chrono::seconds(5);
  bool refused = false;
  while (Clock::now() < deadline) {
    const grpc_connectivity_state state = channel_->GetState(/*try_to_connect=*/true);
    if (state == GRPC_CHANNEL_READY) {
      connected_ = true;
      return grpc::Status::OK;
    }
    if (state == GRPC_CHANNEL_TRANSIENT_FAILURE) {
      refused = true;
      deadline = refused_until;
    }
    channel_->WaitForStateChange(state, deadline);
  }
  return grpc::Status(grpc::StatusCode::UNAVAILABLE, refused ? "the connection is refused" : "no answer");
}

grpc::Status Connection::Repeat(std::chrono::seconds timeout,
                                const std::function<grpc::Status(grpc::ClientContext&)>& call,
                                const std::stop_token& stop) {
  constexpr std::chrono::seconds kPatience(15);
  if (grpc::Status status = Connect(); !status.ok()) return status;
  const Clock::time_point give_up = Clock::now() + kPatience;
  Backoff backoff;
  while (true) {
    grpc::ClientContext context;
    PrepareCall(context);
    context.set_deadline(Clock::now() + timeout);
    const std::stop_callback cancel(stop, [&] { context.TryCancel(); });
    const grpc::Status status = call(context);
    if (!IsTransient(status) || Clock::now() >= give_up) return status;
    backoff.Wait(RetryDelayOf(status), stop);
  }
}

}  // namespace fascicle::client
