#ifndef FASCICLE_SERVER_RPC_ERRORS_H_
#define FASCICLE_SERVER_RPC_ERRORS_H_

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <grpcpp/server_context.h>
#include <grpcpp/support/status.h>
#include <spdlog/logger.h>

#include "core/base/problems.h"

namespace fascicle::server {

// Errors as seen by clients: a status whose details (grpc-status-details-bin) are a google.rpc.Status with an
// ErrorInfo{reason, domain "fascicle"} and the detail message of the code. README.md has the table.

// Size of details [byte] that every gRPC client accepts: by default, a trailer is limited to 8 KiB in all, in base64.
constexpr std::size_t kDefaultDetailsLimit = 5000;

// Size of details that this caller accepts [byte]: the value of its metadata `fascicle-details-limit` (at most 256
// KiB), or the default.
std::size_t DetailsLimit(const grpc::ServerContextBase& call);

// INVALID_ARGUMENT with a BadRequest that lists the problems within `details_limit` [byte]; a last entry counts the
// rest. A description is the message and, on a second line, the hint.
grpc::Status InvalidArgument(const Problems& problems, std::size_t details_limit = kDefaultDetailsLimit);
// The same with one problem.
grpc::Status InvalidArgument(const std::string& field, const std::string& message);
// Like InvalidArgument, with a specific reason.
grpc::Status InvalidArgument(const std::string& reason, const std::string& field, const std::string& message);

// The bytes of a request are not of its type.
grpc::Status NotAMessage();
// UNIMPLEMENTED: no service has `method`.
grpc::Status UnknownMethod(const std::string& method);

// NOT_FOUND with ResourceInfo. `type` is `job` or `asset`.
grpc::Status NotFound(const std::string& type, const std::string& name);
// ALREADY_EXISTS with ResourceInfo.
grpc::Status AlreadyExists(const std::string& reason, const std::string& type, const std::string& name,
                           const std::string& message);
// FAILED_PRECONDITION with one PreconditionFailure.Violation of type `reason` for each subject.
grpc::Status FailedPrecondition(const std::string& reason, const std::vector<std::string>& subjects,
                                const std::string& message, std::size_t details_limit = kDefaultDetailsLimit);
// RESOURCE_EXHAUSTED with QuotaFailure.
grpc::Status ResourceExhausted(const std::string& reason, const std::string& subject, const std::string& message);
// UNAVAILABLE with RetryInfo.
grpc::Status Unavailable(const std::string& reason, const std::string& message, std::chrono::milliseconds retry_after);
grpc::Status ShuttingDown();
grpc::Status Aborted(const std::string& reason, const std::string& message);
grpc::Status OutOfRange(const std::string& reason, const std::string& message);
// OUT_OF_RANGE (FRAMES_REMOVED) with the oldest index.
grpc::Status FramesRemoved(const std::string& job_name, std::int64_t first_frame);
grpc::Status Cancelled();
grpc::Status DeadlineExceeded(const std::string& reason, const std::string& message);
grpc::Status Internal(const std::string& reason, const std::string& message);

// Stored bytes are damaged.
grpc::Status DataLoss(const std::string& message);

// Runs `body`. An exception is logged under `what` and becomes an error: DATA_LOSS for a DamageError,
// RESOURCE_EXHAUSTED (DISK_FULL) for a NoSpaceError, the same (OWNER_LIMIT) for an OwnerLimitError, ALREADY_EXISTS for
// a RequestReusedError, otherwise INTERNAL: STORAGE for a StoreError, OUT_OF_MEMORY, or INTERNAL. Stopped becomes
// CANCELLED.
grpc::Status Guarded(spdlog::logger& log, const char* what, const std::function<grpc::Status()>& body) noexcept;

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_ERRORS_H_
