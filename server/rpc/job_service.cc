#include "server/rpc/job_service.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/digest.h"
#include "core/base/stop.h"
#include "server/rpc/job_messages.h"
#include "server/rpc/names.h"
#include "server/rpc/start_state.h"
#include "server/translate/translate.h"

namespace fascicle::server {
namespace {

void CheckRequest(const v1::CreateJobRequest& request, Problems& problems) {
  if (!request.job().has_scene()) problems.Add("job.scene", "is missing");
  if (request.job().threads() < 0 || request.job().threads() > 256) {
    problems.Add("job.threads", "must be in [0, 256]", "0 selects the server's default");
  }
  if (request.request_id().size() > 64) problems.Add("request_id", "is longer than 64 characters");
}

grpc::Status BadJobName() { return InvalidArgument("name", "must be jobs/{id}"); }

}  // namespace

grpc::ServerUnaryReactor* JobServiceImpl::CreateJob(grpc::CallbackServerContext* call,
                                                    const v1::CreateJobRequest* request, v1::Job* response) {
  return RunStoppable(context_, context_.slow, call, "CreateJob",
                      [this, request, response, limit = DetailsLimit(*call)](const std::stop_token& stop) {
                        return Create(*request, *response, limit, stop);
                      });
}

grpc::Status JobServiceImpl::Create(const v1::CreateJobRequest& request, v1::Job& response, std::size_t details_limit,
                                    const std::stop_token& stop) {
  ThrowIfStopped(stop);
  Problems problems;
  v1::Job job = request.job();
  if (job.has_scene() && job.scene().has_start()) {
    Problems found;
    StoreStartState(context_.store, *job.mutable_scene(), found);
    problems.Append("job.scene", found);
    if (!found.empty()) job.mutable_scene()->clear_start();  // the rest is checked all the same
  }
  const std::vector<std::string> missing = MissingAssets(job.scene());
  if (!missing.empty()) {
    return FailedPrecondition("MISSING_ASSET", missing, "an asset of the scene was not uploaded", details_limit);
  }
  CheckRequest(request, problems);
  Profile profile;
  std::shared_ptr<const Scene> scene;
  if (job.has_scene()) scene = Translate(job.scene(), profile, stop, problems);
  if (!problems.empty()) return InvalidArgument(problems, details_limit);
  if (request.validate_only()) {
    response.set_scene_name(request.job().scene().name());
    response.set_threads(request.job().threads());
    return grpc::Status::OK;
  }
  JobRecord record;
  record.scene_name = request.job().scene().name();
  record.threads = request.job().threads();
  record.spec = SpecOf(job);
  record.profile = EncodeProfileOfCheck(profile).SerializeAsString();
  record.request_id = request.request_id();
  record.request_digest = Hex(Sha256Of(SpecOf(request.job())));
  const std::string digest = record.request_digest;
  bool repeated = false;
  const JobView view = context_.jobs.Submit(std::move(record), &repeated, std::move(scene));
  if (repeated && view.record.request_digest != digest) {
    return AlreadyExists("REQUEST_ID_REUSED", "job", JobName(view.record.id),
                         "request_id " + request.request_id() + " was used for another job");
  }
  response = ToMessage(view);
  return grpc::Status::OK;
}

std::vector<std::string> JobServiceImpl::MissingAssets(const v1::Scene& scene) {
  std::vector<std::string> missing;
  for (const std::string& sha256_hex : AssetsOf(scene)) {
    if (!context_.store.HasAsset(sha256_hex)) missing.push_back(AssetName(sha256_hex));
  }
  return missing;
}

std::shared_ptr<const Scene> JobServiceImpl::Translate(const v1::Scene& scene, Profile& profile,
                                                       const std::stop_token& stop, Problems& problems) {
  const StageTimer timer(&profile, "check");
  const auto read = [this](const std::string& sha256_hex) { return context_.store.ReadAsset(sha256_hex); };
  Problems found;
  TranslateLimits limits;
  limits.max_memory = context_.settings.job_memory;
  limits.max_stored_bytes = context_.store.Room();
  auto translated = TranslateScene(scene, read, found, limits, {&profile, &context_.results, stop});
  if (translated == nullptr && found.empty()) found.Add("", "cannot be translated");
  problems.Append("job.scene", found);
  profile.NoteCpu();
  return translated;
}

grpc::ServerUnaryReactor* JobServiceImpl::GetJob(grpc::CallbackServerContext* call, const v1::GetJobRequest* request,
                                                 v1::Job* response) {
  return RunUnary(context_, context_.kept, call, "GetJob", [this, request, response] {
    const std::optional<std::string> id = ParseJobName(request->name());
    if (!id) return BadJobName();
    const std::optional<JobView> view = context_.jobs.Get(*id);
    if (!view) return NotFound("job", request->name());
    *response = ToMessageWithScene(*view);
    return grpc::Status::OK;
  });
}

grpc::ServerUnaryReactor* JobServiceImpl::ListJobs(grpc::CallbackServerContext* call,
                                                   const v1::ListJobsRequest* request, v1::ListJobsResponse* response) {
  return RunUnary(context_, context_.kept, call, "ListJobs",
                  [this, request, response] { return List(*request, *response); });
}

grpc::Status JobServiceImpl::List(const v1::ListJobsRequest& request, v1::ListJobsResponse& response) {
  Problems problems;
  if (request.page_size() < 0 || request.page_size() > 1000) problems.Add("page_size", "must be in [0, 1000]");
  std::vector<JobState> states;
  std::string filter;
  for (int i = 0; i < request.states_size(); ++i) {
    const int state = request.states(i);
    if (state < v1::Job::STATE_QUEUED || state > v1::Job::STATE_CANCELLED) {
      problems.Add(IndexPath("states", static_cast<std::size_t>(i)), "is not a state of a job");
    }
    states.push_back(static_cast<JobState>(state));
    filter += static_cast<char>('0' + state);
  }
  std::optional<std::string> before = std::string();
  if (!request.page_token().empty()) before = ParsePageToken(request.page_token(), filter);
  if (!before) problems.Add("page_token", "is not from an earlier answer to this request");
  if (!problems.empty()) return InvalidArgument(problems);

  const int page_size = request.page_size() == 0 ? 50 : request.page_size();
  const std::vector<JobView> views = context_.jobs.List(page_size + 1, *before, states);
  for (const JobView& view : views) {
    if (response.jobs_size() == page_size) {  // at least one more exists
      const std::string& last = response.jobs(page_size - 1).name();
      response.set_next_page_token(MakePageToken(*ParseJobName(last), filter));
      break;
    }
    v1::Job& job = *response.add_jobs() = ToMessage(view);
    job.clear_profile();  // as large as everything else
    job.clear_warnings();
  }
  return grpc::Status::OK;
}

grpc::ServerUnaryReactor* JobServiceImpl::CancelJob(grpc::CallbackServerContext* call,
                                                    const v1::CancelJobRequest* request, v1::Job* response) {
  return RunUnary(context_, context_.kept, call, "CancelJob", [this, request, response] {
    const std::optional<std::string> id = ParseJobName(request->name());
    if (!id) return BadJobName();
    const std::optional<JobView> view = context_.jobs.Cancel(*id);
    if (!view) return NotFound("job", request->name());
    *response = ToMessage(*view);
    return grpc::Status::OK;
  });
}

grpc::ServerUnaryReactor* JobServiceImpl::DeleteJob(grpc::CallbackServerContext* call,
                                                    const v1::DeleteJobRequest* request, google::protobuf::Empty*) {
  return RunUnary(context_, context_.quick, call, "DeleteJob", [this, request] {
    const std::optional<std::string> id = ParseJobName(request->name());
    if (!id) return BadJobName();
    switch (context_.jobs.Delete(*id)) {
      case JobManager::DeleteResult::kNotFound:
        return NotFound("job", request->name());
      case JobManager::DeleteResult::kActive:
        return FailedPrecondition("JOB_ACTIVE", {request->name()}, "the job is not in a final state: cancel it first");
      case JobManager::DeleteResult::kDeleted:
        break;
    }
    return grpc::Status::OK;
  });
}

grpc::ServerUnaryReactor* JobServiceImpl::RestartJob(grpc::CallbackServerContext* call,
                                                     const v1::RestartJobRequest* request, v1::Job* response) {
  return RunUnary(context_, context_.quick, call, "RestartJob", [this, request, response] {
    const std::optional<std::string> id = ParseJobName(request->name());
    if (!id) return BadJobName();
    switch (context_.jobs.Restart(*id, request->from_start())) {
      case JobManager::RestartResult::kNotFound:
        return NotFound("job", request->name());
      case JobManager::RestartResult::kActive:
        return FailedPrecondition("JOB_ACTIVE", {request->name()},
                                  "the job has not ended: there is nothing to restart");
      case JobManager::RestartResult::kRestarted:
        break;
    }
    const std::optional<JobView> view = context_.jobs.Get(*id);
    if (!view) return NotFound("job", request->name());
    *response = ToMessage(*view);
    return grpc::Status::OK;
  });
}

grpc::ServerUnaryReactor* JobServiceImpl::VerifyJob(grpc::CallbackServerContext* call,
                                                    const v1::VerifyJobRequest* request,
                                                    v1::VerifyJobResponse* response) {
  return RunStoppable(context_, context_.checks, call, "VerifyJob",
                      [this, request, response](const std::stop_token& stop) {
                        const std::optional<std::string> id = ParseJobName(request->name());
                        if (!id) return BadJobName();
                        const std::optional<JobCheck> check = context_.jobs.Verify(*id, stop);
                        if (!check) return NotFound("job", request->name());
                        response->set_frames(check->frames);
                        response->set_bytes(check->bytes);
                        for (const std::string& damage : check->damages) response->add_damages(damage);
                        return grpc::Status::OK;
                      });
}

}  // namespace fascicle::server
