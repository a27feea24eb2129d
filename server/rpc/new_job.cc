#include "server/rpc/new_job.h"

#include <utility>

#include "core/base/profile.h"
#include "core/base/stop.h"
#include "server/rpc/job_messages.h"
#include "server/rpc/job_settings.h"
#include "server/rpc/names.h"
#include "server/rpc/start_state.h"
#include "server/translate/steering.h"
#include "server/translate/translate.h"

namespace fascicle::server {
namespace {

void CheckRequest(const v1::CreateJobRequest& request, Problems& problems) {
  if (!request.job().has_scene()) problems.Add("job.scene", "is missing");
  if (request.job().threads() < 0 || request.job().threads() > 256) {
    problems.Add("job.threads", "must be in [0, 256]", "0 selects the server's default");
  }
  CheckSettings(request.job(), problems);
  if (request.request_id().size() > 64) problems.Add("request_id", "is longer than 64 characters");
}

// The scene to run; null, with problems, if it is invalid.
std::shared_ptr<const Scene> Translate(RpcContext& context, const v1::Scene& scene, Profile& profile,
                                       const std::stop_token& stop, Problems& problems) {
  const StageTimer timer(&profile, "check");
  const auto read = [&](const std::string& sha256_hex) { return context.store.ReadAsset(sha256_hex); };
  Problems found;
  TranslateLimits limits;
  limits.max_memory = context.settings.job_memory;
  limits.max_stored_bytes = context.store.Room();
  auto translated = TranslateScene(scene, read, found, limits, {&profile, &context.results, stop});
  if (translated == nullptr && found.empty()) found.Add("", "cannot be translated");
  problems.Append("job.scene", found);
  profile.NoteCpu();
  return translated;
}

}  // namespace

std::vector<std::string> MissingAssets(Store& store, const v1::Scene& scene) {
  std::vector<std::string> missing;
  for (const std::string& sha256_hex : AssetsOf(scene)) {
    if (!store.HasAsset(sha256_hex)) missing.push_back(AssetName(sha256_hex));
  }
  return missing;
}

NewJob CheckNewJob(RpcContext& context, const v1::CreateJobRequest& request, const std::stop_token& stop,
                   JobFaults& faults) {
  ThrowIfStopped(stop);
  v1::Job job = request.job();
  if (job.has_scene() && job.scene().has_start()) {
    Problems found;
    StoreStartState(context.store, *job.mutable_scene(), found);
    faults.problems.Append("job.scene", found);
    if (!found.empty()) job.mutable_scene()->clear_start();  // the rest is checked all the same
  }
  faults.missing_assets = MissingAssets(context.store, job.scene());
  if (!faults.missing_assets.empty()) return {};
  CheckRequest(request, faults.problems);
  CheckInputs(job, "job.inputs", faults.problems);
  Profile profile;
  NewJob checked;
  if (job.has_scene()) checked.scene = Translate(context, job.scene(), profile, stop, faults.problems);
  if (!faults.empty()) return {};
  JobRecord& record = checked.record;
  record.scene_name = request.job().scene().name();
  record.threads = request.job().threads();
  record.spec = SpecOf(job);
  record.profile = EncodeProfileOfCheck(profile).SerializeAsString();
  record.request_id = request.request_id();
  record.request_digest = DigestOf(request.job());
  CopySettings(request.job(), record);
  return checked;
}

grpc::Status StatusOf(const JobFaults& faults, std::size_t details_limit) {
  if (!faults.missing_assets.empty()) {
    return FailedPrecondition("MISSING_ASSET", faults.missing_assets, "an asset of the scene was not uploaded",
                              details_limit);
  }
  return faults.problems.empty() ? grpc::Status::OK : InvalidArgument(faults.problems, details_limit);
}

}  // namespace fascicle::server
