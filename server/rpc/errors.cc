#include "server/rpc/errors.h"

#include <algorithm>
#include <charconv>
#include <initializer_list>
#include <new>
#include <utility>

#include "core/base/stop.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "server/jobs/job_manager.h"
#include "server/rpc/names.h"
#include "server/store/store.h"

namespace fascicle::server {
namespace {

using google::protobuf::Message;

grpc::Status MakeStatus(grpc::StatusCode code, const std::string& reason, const std::string& message,
                        std::initializer_list<const Message*> details) {
  google::rpc::Status status;
  status.set_code(code);
  status.set_message(message);
  google::rpc::ErrorInfo info;
  info.set_reason(reason);
  info.set_domain("fascicle");
  status.add_details()->PackFrom(info);
  for (const Message* detail : details) status.add_details()->PackFrom(*detail);
  return grpc::Status(code, message, status.SerializeAsString());
}

std::string OneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

// Limits the length: the message of a status is sent in the trailer, too.
std::string Shortened(std::string text) {
  constexpr std::size_t kLongest = 1000;
  if (text.size() <= kLongest) return text;
  text.resize(kLongest);
  while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0) == 0x80) text.pop_back();
  if (!text.empty() && (static_cast<unsigned char>(text.back()) & 0x80) != 0) text.pop_back();
  return text + "...";
}

std::string Summary(const Problems& problems) {
  const Problem& first = problems.kept().front();
  std::string text = first.path.empty() ? first.message : first.path + ": " + first.message;
  if (problems.count() > 1) text += " (and " + std::to_string(problems.count() - 1) + " more)";
  return Shortened(OneLine(std::move(text)));
}

}  // namespace

std::size_t DetailsLimit(const grpc::ServerContextBase& call) {
  constexpr std::size_t kMost = 256 << 10;
  const auto found = call.client_metadata().find("fascicle-details-limit");
  if (found == call.client_metadata().end()) return kDefaultDetailsLimit;
  std::size_t limit = 0;
  const char* begin = found->second.data();
  const auto [end, error] = std::from_chars(begin, begin + found->second.size(), limit);
  if (error != std::errc() || end != begin + found->second.size()) return kDefaultDetailsLimit;
  return std::clamp(limit, kDefaultDetailsLimit, kMost);
}

grpc::Status InvalidArgument(const Problems& problems, std::size_t details_limit) {
  google::rpc::BadRequest bad;
  std::size_t used = 200;  // ErrorInfo, type names and the closing entry
  std::size_t listed = 0;
  for (const Problem& problem : problems.kept()) {
    std::string description = OneLine(problem.message);
    if (!problem.hint.empty()) description += "\n" + OneLine(problem.hint);
    used += problem.path.size() + description.size() + 12;
    if (used + 2 * Summary(problems).size() > details_limit && listed > 0) break;
    google::rpc::BadRequest::FieldViolation* violation = bad.add_field_violations();
    violation->set_field(problem.path);
    violation->set_description(std::move(description));
    ++listed;
  }
  if (listed < problems.count()) {
    bad.add_field_violations()->set_description("and " + std::to_string(problems.count() - listed) + " more problems");
  }
  return MakeStatus(grpc::StatusCode::INVALID_ARGUMENT, "INVALID_ARGUMENT", Summary(problems), {&bad});
}

grpc::Status InvalidArgument(const std::string& field, const std::string& message) {
  return InvalidArgument("INVALID_ARGUMENT", field, message);
}

grpc::Status InvalidArgument(const std::string& reason, const std::string& field, const std::string& message) {
  google::rpc::BadRequest bad;
  google::rpc::BadRequest::FieldViolation* violation = bad.add_field_violations();
  violation->set_field(field);
  violation->set_description(message);
  return MakeStatus(grpc::StatusCode::INVALID_ARGUMENT, reason, field + ": " + message, {&bad});
}

grpc::Status NotAMessage() { return InvalidArgument("", "the request is not the message type of this call"); }

grpc::Status UnknownMethod(const std::string& method) {
  return MakeStatus(grpc::StatusCode::UNIMPLEMENTED, "UNKNOWN_METHOD",
                    Shortened("this server has no method " + OneLine(method)), {});
}

grpc::Status NotFound(const std::string& type, const std::string& name) {
  google::rpc::ResourceInfo resource;
  resource.set_resource_type("fascicle/" + type);
  resource.set_resource_name(name);
  const std::string message = "there is no " + type + " " + name;
  resource.set_description(message);
  return MakeStatus(grpc::StatusCode::NOT_FOUND, "NOT_FOUND", message, {&resource});
}

grpc::Status AlreadyExists(const std::string& reason, const std::string& type, const std::string& name,
                           const std::string& message) {
  google::rpc::ResourceInfo resource;
  resource.set_resource_type("fascicle/" + type);
  resource.set_resource_name(name);
  resource.set_description(message);
  return MakeStatus(grpc::StatusCode::ALREADY_EXISTS, reason, message, {&resource});
}

grpc::Status FailedPrecondition(const std::string& reason, const std::vector<std::string>& subjects,
                                const std::string& message, std::size_t details_limit) {
  google::rpc::PreconditionFailure failure;
  std::size_t used = 300 + 2 * message.size();
  for (const std::string& subject : subjects) {
    used += subject.size() + reason.size() + message.size() + 16;
    if (used > details_limit && failure.violations_size() > 0) break;
    google::rpc::PreconditionFailure::Violation* violation = failure.add_violations();
    violation->set_type(reason);
    violation->set_subject(subject);
    violation->set_description(message);
  }
  return MakeStatus(grpc::StatusCode::FAILED_PRECONDITION, reason, message, {&failure});
}

grpc::Status ResourceExhausted(const std::string& reason, const std::string& subject, const std::string& message) {
  google::rpc::QuotaFailure failure;
  google::rpc::QuotaFailure::Violation* violation = failure.add_violations();
  violation->set_subject(subject);
  violation->set_description(message);
  return MakeStatus(grpc::StatusCode::RESOURCE_EXHAUSTED, reason, message, {&failure});
}

grpc::Status Unavailable(const std::string& reason, const std::string& message, std::chrono::milliseconds retry_after) {
  google::rpc::RetryInfo retry;
  retry.mutable_retry_delay()->set_seconds(retry_after.count() / 1000);
  retry.mutable_retry_delay()->set_nanos(static_cast<int>(retry_after.count() % 1000) * 1'000'000);
  return MakeStatus(grpc::StatusCode::UNAVAILABLE, reason, message, {&retry});
}

grpc::Status ShuttingDown() {
  return Unavailable("SHUTTING_DOWN", "the server is shutting down", std::chrono::seconds(1));
}

grpc::Status Aborted(const std::string& reason, const std::string& message) {
  return MakeStatus(grpc::StatusCode::ABORTED, reason, message, {});
}

grpc::Status OutOfRange(const std::string& reason, const std::string& message) {
  return MakeStatus(grpc::StatusCode::OUT_OF_RANGE, reason, message, {});
}

grpc::Status FramesRemoved(const std::string& job_name, std::int64_t first_frame) {
  const std::string index = std::to_string(first_frame);
  return OutOfRange("FRAMES_REMOVED", "the frames of " + job_name + " before index " + index +
                                          " were removed to make room; RestartJob from the start computes them again");
}

grpc::Status Cancelled() { return MakeStatus(grpc::StatusCode::CANCELLED, "CANCELLED", "the call was cancelled", {}); }

grpc::Status DeadlineExceeded(const std::string& reason, const std::string& message) {
  return MakeStatus(grpc::StatusCode::DEADLINE_EXCEEDED, reason, message, {});
}

grpc::Status Internal(const std::string& reason, const std::string& message) {
  return MakeStatus(grpc::StatusCode::INTERNAL, reason, message, {});
}

grpc::Status DataLoss(const std::string& message) {
  return MakeStatus(grpc::StatusCode::DATA_LOSS, "DAMAGED", message, {});
}

grpc::Status Guarded(spdlog::logger& log, const char* what, const std::function<grpc::Status()>& body) noexcept {
  try {
    return body();
  } catch (const Stopped&) {
    return Cancelled();
  } catch (const DamageError& e) {
    log.error("{}: damaged data: {}", what, e.what());
    return DataLoss(Shortened(std::string("stored data are damaged: ") + e.what()));
  } catch (const NoSpaceError& e) {
    log.error("{}: the disk is full: {}", what, e.what());
    return ResourceExhausted("DISK_FULL", "disk", "the server's disk is full; delete jobs or free some space");
  } catch (const RequestReusedError& e) {
    return AlreadyExists("REQUEST_ID_REUSED", "job", JobName(e.job_id()), e.what());
  } catch (const OwnerLimitError& e) {
    return ResourceExhausted("OWNER_LIMIT", "owner", e.what());
  } catch (const StoreError& e) {
    log.error("{}: storage failed: {}", what, e.what());
    return Internal("STORAGE", Shortened(std::string("the server's storage failed: ") + e.what()));
  } catch (const std::bad_alloc&) {
    log.error("{}: out of memory", what);
    return Internal("OUT_OF_MEMORY", "the server ran out of memory");
  } catch (const std::exception& e) {
    log.error("{}: {}", what, e.what());
    return Internal("INTERNAL", Shortened(std::string("the server failed: ") + e.what()));
  } catch (...) {
    log.error("{}: unknown exception", what);
    return Internal("INTERNAL", "the server failed");
  }
}

}  // namespace fascicle::server
