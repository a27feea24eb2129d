#ifndef FASCICLE_CLIENT_LIB_CONNECTION_H_
#define FASCICLE_CLIENT_LIB_CONNECTION_H_

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include "fascicle/v1/log_service.grpc.pb.h"
#include "fascicle/v1/simulation_service.grpc.pb.h"
#include "fascicle/v1/steering_service.grpc.pb.h"
#include "fascicle/v1/transfer_service.grpc.pb.h"

namespace fascicle::client {

// A channel with the stubs of all services and a policy for retries. Thread-safe.
class Connection {
 public:
  explicit Connection(const std::string& address);

  const std::string& address() const { return address_; }

  // OK once there is a connection. If there never was one before, gives up after two seconds of refused connections or
  // five seconds without a response. Later calls return at once, because each call detects a lost connection itself.
  grpc::Status Connect();

  // Makes `call` with a deadline, and repeats it with backoff on UNAVAILABLE for up to 15 s. A stop request cancels it
  // with CANCELLED.
  grpc::Status Repeat(std::chrono::seconds timeout, const std::function<grpc::Status(grpc::ClientContext&)>& call,
                      const std::stop_token& stop = {});

  v1::JobService::Stub& jobs() { return *jobs_; }
  v1::AssetService::Stub& assets() { return *assets_; }
  v1::FrameService::Stub& frames() { return *frames_; }
  v1::ServerService::Stub& server() { return *server_; }
  v1::TransferService::Stub& transfers() { return *transfers_; }
  v1::SteeringService::Stub& steering() { return *steering_; }
  v1::LogService::Stub& logs() { return *logs_; }

 private:
  const std::string address_;
  const std::shared_ptr<grpc::Channel> channel_;
  std::atomic<bool> connected_ = false;  // whether there has been a connection
  const std::unique_ptr<v1::JobService::Stub> jobs_;
  const std::unique_ptr<v1::AssetService::Stub> assets_;
  const std::unique_ptr<v1::FrameService::Stub> frames_;
  const std::unique_ptr<v1::ServerService::Stub> server_;
  const std::unique_ptr<v1::TransferService::Stub> transfers_;
  const std::unique_ptr<v1::SteeringService::Stub> steering_;
  const std::unique_ptr<v1::LogService::Stub> logs_;
};

// Allows the server to send long lists of problems.
void PrepareCall(grpc::ClientContext& context);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_CONNECTION_H_
