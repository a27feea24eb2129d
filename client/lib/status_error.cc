#include "client/lib/status_error.h"

#include <optional>
#include <string_view>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace fascicle::client {
namespace {

// The first detail of one kind.
template <class Detail>
std::optional<Detail> DetailOf(const grpc::Status& status) {
  google::rpc::Status packed;
  if (!packed.ParseFromString(status.error_details())) return std::nullopt;
  Detail detail;
  for (const google::protobuf::Any& any : packed.details()) {
    if (any.UnpackTo(&detail)) return detail;
  }
  return std::nullopt;
}

Error::Kind KindOfStatus(grpc::StatusCode code) {
  switch (code) {
    case grpc::StatusCode::INVALID_ARGUMENT:
      return Error::Kind::kInvalid;
    case grpc::StatusCode::UNAVAILABLE:
    case grpc::StatusCode::DEADLINE_EXCEEDED:
      return Error::Kind::kNoServer;
    case grpc::StatusCode::NOT_FOUND:
      return Error::Kind::kNotFound;
    case grpc::StatusCode::ALREADY_EXISTS:
    case grpc::StatusCode::FAILED_PRECONDITION:
    case grpc::StatusCode::RESOURCE_EXHAUSTED:
    case grpc::StatusCode::ABORTED:
    case grpc::StatusCode::OUT_OF_RANGE:
    case grpc::StatusCode::PERMISSION_DENIED:
    case grpc::StatusCode::UNAUTHENTICATED:
      return Error::Kind::kRefused;
    case grpc::StatusCode::CANCELLED:
      return Error::Kind::kStopped;
    default:
      return Error::Kind::kInternal;
  }
}

void AddProblems(const google::rpc::BadRequest& bad, Problems& problems) {
  for (const auto& violation : bad.field_violations()) {
    const std::string& description = violation.description();
    const std::size_t line_end = description.find('\n');
    problems.Add(ScenePath(violation.field()), description.substr(0, line_end),
                 line_end == std::string::npos ? "" : description.substr(line_end + 1));
  }
}

}  // namespace

std::string ScenePath(std::string_view field) {
  constexpr std::string_view kScene = "job.scene";
  if (field == kScene) return "";
  if (field.starts_with(kScene) && field[kScene.size()] == '.') field.remove_prefix(kScene.size() + 1);
  return std::string(field);
}

Error ErrorOf(const grpc::Status& status, const std::string& address) {
  Error error;
  error.kind = KindOfStatus(status.error_code());
  error.message = status.error_message();
  if (error.message.empty()) error.message = "error " + std::to_string(status.error_code());
  if (const auto info = DetailOf<google::rpc::ErrorInfo>(status)) error.reason = info->reason();
  if (const auto bad = DetailOf<google::rpc::BadRequest>(status)) AddProblems(*bad, error.problems);
  if (const auto failure = DetailOf<google::rpc::PreconditionFailure>(status)) {
    for (const auto& violation : failure->violations()) error.message += "\n  " + violation.subject();
  }
  if (error.kind == Error::Kind::kNoServer && error.reason.empty()) {
    error.message = "no server answers at " + address + " (" + error.message + ")";
  }
  return error;
}

bool IsTransient(const grpc::Status& status) { return status.error_code() == grpc::StatusCode::UNAVAILABLE; }

bool IsLostStream(const grpc::Status& status) {
  switch (status.error_code()) {
    case grpc::StatusCode::OK:  // without the message that completes the stream
    case grpc::StatusCode::UNAVAILABLE:
    case grpc::StatusCode::CANCELLED:
    case grpc::StatusCode::DEADLINE_EXCEEDED:
      return true;
    case grpc::StatusCode::INTERNAL:
    case grpc::StatusCode::UNKNOWN:
      return status.error_details().empty();  // an error of the transport; the service's own errors have details
    default:
      return false;
  }
}

std::chrono::milliseconds RetryDelayOf(const grpc::Status& status) {
  const auto retry = DetailOf<google::rpc::RetryInfo>(status);
  if (!retry) return std::chrono::milliseconds(0);
  return std::chrono::milliseconds(retry->retry_delay().seconds() * 1000 + retry->retry_delay().nanos() / 1'000'000);
}

}  // namespace fascicle::client
