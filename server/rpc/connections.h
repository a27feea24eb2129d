#ifndef FASCICLE_SERVER_RPC_CONNECTIONS_H_
#define FASCICLE_SERVER_RPC_CONNECTIONS_H_

#include <array>
#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include <grpcpp/support/status.h>
#include <spdlog/logger.h>

#include "server/rpc/limits.h"

namespace fascicle::server {

// What a call uses. Calls that are kept show and stop jobs: they have a place when all others are taken.
enum class CallKind { kKept, kCall, kSubmission, kUpload, kStream };
constexpr std::size_t kCallKinds = 5;

// The connections of clients and their calls, within limits. Thread-safe.
class Connections {
 public:
  struct Connection;
  using Handle = std::shared_ptr<Connection>;
  // A place of a call; destroying it gives it back.
  using Place = std::shared_ptr<void>;
  struct Entry {
    Place place;          // null if refused
    grpc::Status status;  // why
  };

  Connections(const Limits& limits, spdlog::logger& log);

  // A connection that gRPC knows by its own `descriptor`; `socket` is a duplicate, which stays open until Close. Beyond
  // the limit, a connection is for kept calls only.
  Handle Open(int descriptor, int socket);
  void Close(const Handle& connection);
  // Whether there is no place for another connection.
  bool Full() const;
  // Ends the connection that has been without calls for longest, if that is some seconds; its Close follows.
  void EndLongestIdle();
  // Ends connections that never made a call, and logs what was ended. Call every second.
  void EndSilent();

  // A call of `peer` (as gRPC names it), whether served or not. A connection that resets many calls, or starts more
  // than can end, is ended: gRPC 1.51 keeps 12 KB of each until it has time for it, and all others wait behind them.
  Handle BeginCall(const std::string& peer);
  // Its client has given it up.
  void NoteReset(const Handle& connection);
  void EndCall(const Handle& connection);

  // A place for a call of `peer`.
  Entry Enter(const std::string& peer, CallKind kind);

 private:
  // The functions below need `mutex_`.
  Handle Find(const std::string& peer) const;
  void End(const Handle& connection);
  void EndFlood(const Handle& connection);

  const Limits limits_;
  spdlog::logger& log_;
  mutable std::mutex mutex_;
  std::map<std::string, Handle> by_peer_;
  const Handle unknown_;  // stands for connections that are closed already
  std::array<int, kCallKinds> used_ = {};
  int unfinished_ = 0;  // calls
  int flooding_ = 0;    // ended since the last line of the log
  int silent_ = 0;      // likewise
  std::chrono::steady_clock::time_point last_line_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_CONNECTIONS_H_
