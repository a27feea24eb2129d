#include "client/cli/skeleton_run.h"

#include <iostream>
#include <set>
#include <string>
#include <utility>

#include "core/base/stop.h"
#include "proto/rules/find_messages.h"

namespace fascicle::client {

ScenePackage SkeletonOf(const ScenePackage& package) {
  if (!package.scene.has_skeleton()) {
    throw CommandError::Invalid("the scene has no skeleton; `fascicle import model.osim --out DIR` makes one with it");
  }
  ScenePackage alone;
  alone.scene = package.scene;
  v1::Scene& scene = alone.scene;
  scene.clear_bodies();
  scene.clear_floors();
  scene.clear_rigid_bodies();
  scene.clear_contacts();
  scene.clear_squeezes();
  scene.clear_start();
  scene.clear_refinements();
  const double interval = scene.output().frame_interval();
  scene.clear_output();
  scene.mutable_output()->set_frame_interval(interval);
  scene.clear_method();
  scene.mutable_tet();
  std::set<std::string> named;
  ForEachMessage<v1::FileRef>(scene, "",
                              [&](const v1::FileRef& file, const std::string&) { named.insert(file.asset()); });
  for (const AssetFile& asset : package.assets) {
    if (named.contains("assets/" + asset.sha256_hex)) alone.assets.push_back(asset);
  }
  return alone;
}

SkeletonRuns::SkeletonRuns(std::stop_token stop) : stop_(std::move(stop)) {
  server::ServerOptions options;
  options.data_directory = folder_.path().string();
  options.workers = 1;
  options.default_threads = 1;
  server_ = server::EmbeddedServer::Start(options);
  client_ = std::make_unique<Client>(server_->address());
}

SkeletonRuns::~SkeletonRuns() {
  client_.reset();
  server_->Stop();
}

Followed SkeletonRuns::Run(const ScenePackage& package) {
  const v1::Job job = Take(client_->Submit(package, 1, stop_));
  Followed followed = Follow(*client_, job.name(), OnlySeries(), {}, stop_);
  if (followed.stopped) throw Stopped();
  if (followed.job.state() != v1::Job::STATE_SUCCEEDED) {
    throw CommandError(
        Error{Error::Kind::kInternal, followed.job.failure().message(), followed.job.failure().reason(), {}});
  }
  return followed;
}

void PrintNotes(const Followed& followed) {
  for (const std::string& note : followed.geometry.notes()) std::cerr << "note  " << note << '\n';
}

}  // namespace fascicle::client
