#include "server/rpc/steering_service.h"

#include <optional>
#include <string>
#include <utility>

#include "server/rpc/job_messages.h"
#include "server/rpc/names.h"
#include "server/translate/steering.h"

namespace fascicle::server {
namespace {

// The scene of a job.
v1::Scene SceneOf(const JobView& view) {
  v1::Job spec;
  if (!spec.ParseFromString(view.record.spec)) throw DamageError("the specification of job " + view.record.id);
  return std::move(*spec.mutable_scene());
}

v1::SteeringInput ToMessage(const SteeringRecord& record, std::int64_t reached_step) {
  v1::SteeringInput input;
  if (!input.ParseFromString(record.input)) throw DamageError("input " + std::to_string(record.sequence));
  if (record.step) input.set_step(*record.step);
  input.set_applied(record.step && *record.step <= reached_step);
  *input.mutable_accept_time() = TimestampOf(record.accept_time_us);
  return input;
}

std::vector<std::string> NamesOf(const std::vector<SteeringTarget>& targets) {
  std::vector<std::string> names;
  for (const SteeringTarget& target : targets) names.push_back(target.name);
  return names;
}

}  // namespace

grpc::ServerUnaryReactor* SteeringServiceImpl::ApplySteering(grpc::CallbackServerContext* call,
                                                             const v1::ApplySteeringRequest* request,
                                                             v1::ApplySteeringResponse* response) {
  return RunUnary(context_, context_.quick, call, "ApplySteering",
                  [this, request, response, limit = DetailsLimit(*call)] { return Apply(*request, *response, limit); });
}

grpc::Status SteeringServiceImpl::Apply(const v1::ApplySteeringRequest& request, v1::ApplySteeringResponse& response,
                                        std::size_t details_limit) {
  const std::optional<std::string> id = ParseJobName(request.name());
  if (!id) return InvalidArgument("name", "must be jobs/{id}");
  const std::optional<JobView> view = context_.jobs.Get(*id);
  if (!view) return NotFound("job", request.name());
  v1::SteeringInput input = request.input();
  Problems problems;
  SteeringInput translated = TranslateSteering(SceneOf(*view), "input", input, problems);

  SteeringRequest asked;
  asked.sequence = input.sequence();
  asked.input = EncodeSteering(input);
  asked.controls = std::move(translated.controls);
  asked.ramp = translated.ramp;
  if (input.has_at_step()) asked.at_step = input.at_step();
  if (input.has_at_time()) asked.at_time = input.at_time();
  const std::optional<SteeringAnswer> answer = context_.jobs.Steer(*id, asked, /*check_only=*/!problems.empty());
  if (!answer) return NotFound("job", request.name());
  if (!problems.empty()) {
    problems.Append("", answer->problems);
    return InvalidArgument(problems, details_limit);
  }
  if (!answer->record) {
    const Problem& first = answer->problems.kept().front();
    const std::string hint = first.hint.empty() ? "" : "; " + first.hint;
    return FailedPrecondition(answer->reason, {request.name()}, first.path + ": " + first.message + hint);
  }
  *response.mutable_input() = ToMessage(*answer->record, 0);
  return grpc::Status::OK;
}

grpc::ServerUnaryReactor* SteeringServiceImpl::ListSteering(grpc::CallbackServerContext* call,
                                                            const v1::ListSteeringRequest* request,
                                                            v1::ListSteeringResponse* response) {
  return RunUnary(context_, context_.quick, call, "ListSteering",
                  [this, request, response] { return List(*request, *response); });
}

grpc::Status SteeringServiceImpl::List(const v1::ListSteeringRequest& request, v1::ListSteeringResponse& response) {
  constexpr int kPage = 200, kLargestPage = 500;
  Problems problems;
  const std::optional<std::string> id = ParseJobName(request.name());
  if (!id) problems.Add("name", "must be jobs/{id}");
  if (request.start_sequence() < 0) problems.Add("start_sequence", "must not be negative");
  if (request.page_size() < 0 || request.page_size() > kLargestPage) problems.Add("page_size", "must be in [0, 500]");
  if (!problems.empty()) return InvalidArgument(problems);
  const std::optional<JobView> view = context_.jobs.Get(*id);
  const int limit = request.page_size() == 0 ? kPage : request.page_size();
  const auto list = view ? context_.jobs.ListSteering(*id, request.start_sequence(), limit) : std::nullopt;
  if (!list) return NotFound("job", request.name());
  for (const SteeringRecord& record : list->inputs) *response.add_inputs() = ToMessage(record, list->reached_step);
  response.set_next_sequence(list->next_sequence);
  const SteeringTargets targets = SteeringTargetsOf(SceneOf(*view));
  for (const std::string& name : NamesOf(targets.activations)) response.add_activations(name);
  for (const std::string& name : NamesOf(targets.loads)) response.add_loads(name);
  for (const std::string& name : NamesOf(targets.motions)) response.add_motions(name);
  return grpc::Status::OK;
}

}  // namespace fascicle::server
