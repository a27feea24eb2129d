#include "server/rpc/server_service.h"

namespace fascicle::server {

grpc::ServerUnaryReactor* ServerServiceImpl::GetServerInfo(grpc::CallbackServerContext* call,
                                                           const v1::GetServerInfoRequest*, v1::ServerInfo* response) {
  response->set_version(FASCICLE_VERSION);
  response->add_methods("tet");
  response->add_methods("voxel");
  response->add_methods("eulerian");
  response->set_workers(context_.settings.workers);
  response->set_default_threads(context_.settings.default_threads);
  response->set_max_asset_size(context_.settings.max_asset_size);
  const auto uptime = std::chrono::steady_clock::now() - start_;
  const auto seconds = std::chrono::floor<std::chrono::seconds>(uptime);
  response->mutable_uptime()->set_seconds(seconds.count());
  response->mutable_uptime()->set_nanos(
      static_cast<int>(std::chrono::duration_cast<std::chrono::nanoseconds>(uptime - seconds).count()));
  grpc::ServerUnaryReactor* reactor = call->DefaultReactor();
  reactor->Finish(grpc::Status::OK);
  return reactor;
}

}  // namespace fascicle::server
