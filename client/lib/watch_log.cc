#include "client/lib/watch_log.h"

#include <chrono>
#include <utility>

#include "client/lib/message_stream.h"
#include "client/lib/patience.h"
#include "client/lib/status_error.h"

namespace fascicle::client {

Result<v1::Job> WatchLog(Connection& connection, const std::string& name, const LogOptions& options,
                         const std::function<void(const v1::LogLine&)>& on_line, const std::stop_token& stop) {
  using Stream = MessageStream<v1::StreamLogResponse>;
  if (grpc::Status status = connection.Connect(); !status.ok()) return ErrorOf(status, connection.address());
  v1::StreamLogRequest request;
  request.set_name(name);
  request.set_tail(options.tail);
  request.set_follow(options.follow);
  Patience patience(WatchOptions().patience);
  while (true) {
    Stream stream([&](grpc::ClientContext* call, grpc::ClientReadReactor<v1::StreamLogResponse>* reactor) {
      PrepareCall(*call);
      connection.logs().async()->StreamLog(call, &request, reactor);
    });
    v1::StreamLogResponse message;
    Stream::Outcome outcome = Stream::Outcome::kMessage;
    while ((outcome = stream.Next(message, kLongestSilence, stop)) == Stream::Outcome::kMessage) {
      patience.Succeeded();
      for (const v1::LogLine& line : message.lines()) {
        on_line(line);
        request.set_start_number(line.number() + 1);
        request.set_tail(0);  // all that follow, should the connection be lost
      }
      if (message.has_job()) return std::move(*message.mutable_job());
    }
    if (outcome == Stream::Outcome::kStopped) return Error{Error::Kind::kStopped, "stopped", "", {}};
    const grpc::Status status = outcome == Stream::Outcome::kEnd
                                    ? stream.status()
                                    : grpc::Status(grpc::StatusCode::UNAVAILABLE, "the server does not respond");
    if (!IsLostStream(status)) return ErrorOf(status, connection.address());
    patience.Lost();
    if (patience.exhausted()) {
      Error error = ErrorOf(status, connection.address());
      error.kind = Error::Kind::kNoServer;
      return error;
    }
    patience.Wait(status, stop);
  }
}

}  // namespace fascicle::client
