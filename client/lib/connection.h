#ifndef FASCICLE_CLIENT_LIB_CONNECTION_H_
#define FASCICLE_CLIENT_LIB_CONNECTION_H_

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include "fascicle/v1/simulation_service.grpc.pb.h"

namespace fascicle::client {

// A channel with the stubs of all services, and when to try again. Thread-safe.
class Connection {
 public:
  explicit Connection(const std::string& address);

  const std::string& address() const { return address_; }

  // OK once there is a connection. Gives up after two seconds of refusals or five of silence, when there never was
  // one before; later calls return at once, as each call finds out by itself.
  grpc::Status Connect();

  // Makes `call` with a deadline, and again with backoff while it says UNAVAILABLE, for a quarter of a minute.
  grpc::Status Repeat(std::chrono::seconds timeout, const std::function<grpc::Status(grpc::ClientContext&)>& call);

  v1::JobService::Stub& jobs() { return *jobs_; }
  v1::AssetService::Stub& assets() { return *assets_; }
  v1::FrameService::Stub& frames() { return *frames_; }
  v1::ServerService::Stub& server() { return *server_; }

 private:
  const std::string address_;
  const std::shared_ptr<grpc::Channel> channel_;
  std::atomic<bool> connected_ = false;  // once
  const std::unique_ptr<v1::JobService::Stub> jobs_;
  const std::unique_ptr<v1::AssetService::Stub> assets_;
  const std::unique_ptr<v1::FrameService::Stub> frames_;
  const std::unique_ptr<v1::ServerService::Stub> server_;
};

// Lets the server send long lists of problems.
void PrepareCall(grpc::ClientContext& context);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_CONNECTION_H_
