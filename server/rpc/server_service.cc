#include "server/rpc/server_service.h"

#include <algorithm>
#include <thread>

namespace fascicle::server {
namespace {

google::protobuf::Duration ToMessage(std::chrono::nanoseconds time) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  google::protobuf::Duration message;
  message.set_seconds(seconds.count());
  message.set_nanos(static_cast<int>((time - seconds).count()));
  return message;
}

v1::ServerInfo::Limits ToMessage(const Limits& limits) {
  v1::ServerInfo::Limits message;
  message.set_connections(limits.connections);
  message.set_streams(limits.streams.in_all);
  message.set_streams_of_connection(limits.streams.of_connection);
  message.set_uploads(limits.uploads.in_all);
  message.set_uploads_of_connection(limits.uploads.of_connection);
  message.set_submissions(limits.submissions.in_all);
  message.set_submissions_of_connection(limits.submissions.of_connection);
  message.set_calls(limits.calls.in_all);
  message.set_calls_of_connection(limits.calls.of_connection);
  *message.mutable_idle_upload() = ToMessage(limits.idle_upload);
  *message.mutable_longest_check() = ToMessage(limits.longest_check);
  return message;
}

}  // namespace

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
  *response->mutable_uptime() = ToMessage(std::chrono::steady_clock::now() - start_);
  *response->mutable_limits() = ToMessage(context_.settings.limits);
  grpc::ServerUnaryReactor* reactor = call->DefaultReactor();
  reactor->Finish(grpc::Status::OK);
  return reactor;
}

}  // namespace fascicle::server
