#include "server/rpc/job_service.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/jobs/active_job.h"
#include "server/rpc/job_batch.h"
#include "server/rpc/job_filter.h"
#include "server/rpc/job_messages.h"
#include "server/rpc/job_settings.h"
#include "server/rpc/job_watch_stream.h"
#include "server/rpc/names.h"
#include "server/rpc/new_job.h"
#include "server/rpc/raw_request.h"

namespace fascicle::server {
namespace {

// The states of a request as one group of a filter.
std::vector<JobCondition> AnyState(const v1::ListJobsRequest& request, Problems& problems) {
  std::vector<JobCondition> conditions;
  for (int i = 0; i < request.states_size(); ++i) {
    const int state = request.states(i);
    if (state == v1::Job::STATE_UNSPECIFIED || !v1::Job::State_IsValid(state)) {
      problems.Add(IndexPath("states", static_cast<std::size_t>(i)), "is not a state of a job");
    }
    conditions.push_back({.field = JobField::kState, .number = state});
  }
  if (conditions.size() > 32) problems.Add("states", "are more than 32");
  return conditions;
}

// The answer of PauseJob and ResumeJob.
grpc::Status AnswerUnlessOver(const std::string& name, const std::optional<JobView>& view, v1::Job& response) {
  if (!view) return NotFound("job", name);
  if (IsFinal(view->record.state) || view->record.state == JobState::kCancelling) {
    return FailedPrecondition("JOB_FINAL", {name}, "the job has ended or is being cancelled");
  }
  response = ToMessage(*view);
  return grpc::Status::OK;
}

grpc::Status BadJobName() { return InvalidArgument("name", "must be jobs/{id}"); }

}  // namespace

grpc::ServerUnaryReactor* JobServiceImpl::CreateJob(grpc::CallbackServerContext* call,
                                                    const v1::CreateJobRequest* request, v1::Job* response) {
  auto* reactor = new StoppableReactor;
  Connections::Entry entry = context_.Enter(*call, CallKind::kSubmission);
  if (!entry.status.ok()) {
    reactor->Finish(entry.status);
    return reactor;
  }
  const auto checked = std::make_shared<NewJob>();
  context_.slow.Post([this, reactor, request, response, checked, place = std::move(entry.place),
                      limit = DetailsLimit(*call), stop = reactor->stop()] {
    const std::chrono::milliseconds longest = context_.settings.limits.longest_check;
    const RunningChecks::Watch watch(context_.running_checks, stop, longest);
    const grpc::Status status = Guarded(context_.log, "CreateJob", [&] {
      JobFaults faults;
      *checked = CheckNewJob(context_, *request, stop.get_token(), faults);
      return StatusOf(faults, limit);
    });
    if (watch.expired()) return reactor->Finish(TookTooLong(longest));
    if (!status.ok() || request->validate_only()) {
      response->set_scene_name(request->job().scene().name());
      response->set_threads(request->job().threads());
      return reactor->Finish(status);
    }
    const auto store = [this, reactor, response, checked, place] {
      reactor->Finish(Guarded(context_.log, "CreateJob", [&] {
        *response = ToMessage(context_.jobs.Submit(std::move(checked->record), nullptr, std::move(checked->scene)));
        return grpc::Status::OK;
      }));
    };
    // A single client is spared a change of threads. Of many, other threads wait for the disk, and share a commit.
    if (context_.slow.HasNoneWaiting()) return store();
    context_.commits.Post(store);
  });
  return reactor;
}

grpc::ServerUnaryReactor* JobServiceImpl::BatchCreateJobs(grpc::CallbackServerContext* call,
                                                          const v1::BatchCreateJobsRequest* request,
                                                          v1::BatchCreateJobsResponse* response) {
  return RunStoppable(context_, context_.slow, call, "BatchCreateJobs",
                      [this, request, response, limit = DetailsLimit(*call)](const std::stop_token& stop) {
                        return CreateBatch(context_, *request, limit, stop, *response);
                      });
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
  const int page_size = request.page_size() == 0 ? 50 : request.page_size();
  JobQuery query = {.filter = ParseJobFilter(request.filter(), UnixTimeUs(), problems), .limit = page_size + 1};
  ParseJobOrder(request.order_by(), query, problems);
  std::string list = request.filter() + '\n' + request.order_by() + '\n';
  if (const std::vector<JobCondition> states = AnyState(request, problems); !states.empty()) {
    query.filter.groups.push_back(states);
    for (const int state : request.states()) list += std::to_string(state) + ",";
  }
  if (!request.page_token().empty()) {
    query.after = ParsePageToken(request.page_token(), list);
    if (!query.after) problems.Add("page_token", "is not from an earlier answer to this request");
  }
  if (!problems.empty()) return InvalidArgument(problems);

  const std::vector<JobView> views = context_.jobs.Find(query);
  for (const JobView& view : views) {
    if (response.jobs_size() == page_size) {  // at least one more exists
      const JobRecord& last = views[static_cast<std::size_t>(page_size) - 1].record;
      response.set_next_page_token(MakePageToken(PlaceOf(last, query.order), list));
      break;
    }
    *response.add_jobs() = ToListedMessage(view);
  }
  return grpc::Status::OK;
}

grpc::ServerWriteReactor<grpc::ByteBuffer>* JobServiceImpl::WatchJobs(grpc::CallbackServerContext* call,
                                                                      const grpc::ByteBuffer* request) {
  auto parsed = ParseRequest<v1::WatchJobsRequest>(*request);
  if (!parsed) return new EndedStream(NotAMessage());
  return OutStream::Launch(*call, std::make_shared<JobWatchStream>(context_, std::move(*parsed)));
}

grpc::ServerUnaryReactor* JobServiceImpl::UpdateJob(grpc::CallbackServerContext* call,
                                                    const v1::UpdateJobRequest* request, v1::Job* response) {
  return RunUnary(context_, context_.quick, call, "UpdateJob",
                  [this, request, response] { return Update(*request, *response); });
}

grpc::Status JobServiceImpl::Update(const v1::UpdateJobRequest& request, v1::Job& response) {
  Problems problems;
  const std::optional<std::string> id = ParseJobName(request.job().name());
  if (!id) problems.Add("job.name", "must be jobs/{id}");
  CheckUpdate(request, problems);
  if (!problems.empty()) return InvalidArgument(problems);
  const std::optional<JobView> view =
      context_.jobs.ChangeSettings(*id, [&](JobRecord& record) { ApplyUpdate(request, record, problems); });
  if (!problems.empty()) return InvalidArgument(problems);
  if (!view) return NotFound("job", request.job().name());
  response = ToMessage(*view);
  return grpc::Status::OK;
}

grpc::ServerUnaryReactor* JobServiceImpl::PauseJob(grpc::CallbackServerContext* call,
                                                   const v1::PauseJobRequest* request, v1::Job* response) {
  return RunUnary(context_, context_.quick, call, "PauseJob", [this, request, response] {
    const std::optional<std::string> id = ParseJobName(request->name());
    if (!id) return BadJobName();
    return AnswerUnlessOver(request->name(), context_.jobs.Pause(*id), *response);
  });
}

grpc::ServerUnaryReactor* JobServiceImpl::ResumeJob(grpc::CallbackServerContext* call,
                                                    const v1::ResumeJobRequest* request, v1::Job* response) {
  return RunUnary(context_, context_.quick, call, "ResumeJob", [this, request, response] {
    const std::optional<std::string> id = ParseJobName(request->name());
    if (!id) return BadJobName();
    return AnswerUnlessOver(request->name(), context_.jobs.Resume(*id), *response);
  });
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
    // Of a job that was imported, perhaps.
    v1::Job spec;
    if (const auto view = context_.jobs.Get(*id)) spec.ParseFromString(view->record.spec);
    if (const std::vector<std::string> missing = MissingAssets(context_.store, spec.scene()); !missing.empty()) {
      return FailedPrecondition("MISSING_ASSET", missing, "files of the scene are not on this server: submit it again");
    }
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
