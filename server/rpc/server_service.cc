#include "server/rpc/server_service.h"

#include <algorithm>
#include <thread>

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
  const RpcSettings& settings = context_.settings;
  response->set_cores(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  response->set_oversubscribe(settings.oversubscribe);
  const WorkLoad load = context_.jobs.Load();
  response->set_running_jobs(load.running);
  response->set_threads_in_use(load.threads);
  response->set_queued_jobs(load.queued);
  response->set_max_queued_jobs_per_owner(settings.max_queued_per_owner);
  response->set_max_running_jobs_per_owner(settings.max_running_per_owner);
  response->set_max_stored_bytes_per_owner(settings.max_stored_per_owner);
  if (settings.default_ttl_s > 0) response->mutable_default_ttl()->set_seconds(settings.default_ttl_s);
  response->set_disk_budget(settings.disk_budget);
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
