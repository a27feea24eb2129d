#include "client/lib/watch_jobs.h"

#include <chrono>

#include "client/lib/message_stream.h"
#include "client/lib/patience.h"
#include "client/lib/status_error.h"

namespace fascicle::client {
namespace {

using JobsStream = MessageStream<v1::WatchJobsResponse>;

// Reads one stream to its end. `request.revision` stays the last one received.
grpc::Status ReadChanges(Connection& connection, v1::WatchJobsRequest& request, const JobsWatch& watch,
                         Patience& patience, const std::stop_token& stop) {
  const v1::WatchJobsRequest sent = request;
  JobsStream stream([&](grpc::ClientContext* call, grpc::ClientReadReactor<v1::WatchJobsResponse>* reactor) {
    PrepareCall(*call);
    connection.jobs().async()->WatchJobs(call, &sent, reactor);
  });
  v1::WatchJobsResponse message;
  while (true) {
    switch (stream.Next(message, kLongestSilence, stop)) {
      case JobsStream::Outcome::kMessage:
        patience.Succeeded();
        if (watch.changes && (message.jobs_size() > 0 || message.removed_size() > 0)) watch.changes(message);
        request.set_revision(message.revision());
        break;
      case JobsStream::Outcome::kEnd:
        return stream.status();
      case JobsStream::Outcome::kSilence:
        return grpc::Status(grpc::StatusCode::UNAVAILABLE, "the server does not respond");
      case JobsStream::Outcome::kStopped:
        return grpc::Status::CANCELLED;
    }
  }
}

}  // namespace

Error WatchAllJobs(Connection& connection, const JobsWatch& watch, const std::stop_token& stop) {
  if (grpc::Status status = connection.Connect(); !status.ok()) return ErrorOf(status, connection.address());
  v1::WatchJobsRequest request;
  request.set_filter(watch.filter);
  request.set_revision(watch.revision);
  Patience patience(watch.patience);
  while (true) {
    const grpc::Status status = ReadChanges(connection, request, watch, patience, stop);
    if (stop.stop_requested()) return {Error::Kind::kStopped, "stopped", "", {}};
    if (!IsLostStream(status)) return ErrorOf(status, connection.address());
    if (patience.Lost() && watch.reconnecting) watch.reconnecting(status.error_message());
    if (patience.exhausted()) {
      Error error = ErrorOf(status, connection.address());
      error.kind = Error::Kind::kNoServer;
      return error;
    }
    patience.Wait(status, stop);
  }
}

}  // namespace fascicle::client
