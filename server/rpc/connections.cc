#include "server/rpc/connections.h"

#include <sys/socket.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "server/rpc/errors.h"

namespace fascicle::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kReservedConnections = 16;  // beyond the limit, for kept calls
constexpr std::chrono::seconds kShortestIdle(5);
constexpr int kUploadBuffer = 1 << 20;  // bytes that may wait for gRPC once files are uploaded; see listener.cc
// A connection may reset many calls at once, for example when its user closes a window, and some all the time.
constexpr double kMostResets = 400;
constexpr double kResetsPerSecond = 100;
// HTTP/2 allows a connection 256 calls at once; more are unfinished only if it resets them.
constexpr int kMostUnfinished = 1024;       // of a connection
constexpr int kManyUnfinished = 8192;       // in all
constexpr int kMostUnfinishedOfMany = 512;  // of a connection while there are many in all

std::size_t IndexOf(CallKind kind) { return static_cast<std::size_t>(kind); }

const CallLimit& LimitOf(const Limits& limits, CallKind kind) {
  const std::array<const CallLimit*, kCallKinds> all = {&limits.kept_calls, &limits.calls, &limits.submissions,
                                                        &limits.uploads, &limits.streams};
  return *all[IndexOf(kind)];
}

const char* NameOf(CallKind kind) {
  constexpr std::array<const char*, kCallKinds> kNames = {"calls", "calls", "submissions", "uploads", "streams"};
  return kNames[IndexOf(kind)];
}

grpc::Status NoConnectionLeft(int most) {
  return Unavailable("TOO_MANY_CONNECTIONS",
                     "the server has all of its " + std::to_string(most) +
                         " connections: this one can show and cancel jobs only. Try again later",
                     std::chrono::seconds(5));
}

grpc::Status NoneLeft(CallKind kind, int most) {
  return Unavailable("OVERLOADED",
                     "the server has all of its " + std::to_string(most) + " " + NameOf(kind) + ": try again later",
                     std::chrono::seconds(2));
}

grpc::Status NoneLeftOfConnection(CallKind kind, int most) {
  return Unavailable(
      "TOO_MANY_CALLS",
      "this connection has all of its " + std::to_string(most) + " " + NameOf(kind) + ": let some of them end",
      std::chrono::seconds(1));
}

}  // namespace

struct Connections::Connection {
  std::string peer;
  int socket = -1;  // negative: closed
  bool ended = false;
  bool kept_only = false;
  int unfinished = 0;
  std::int64_t calls = 0;
  std::array<int, kCallKinds> used = {};
  Clock::time_point last_use = Clock::now();
  double resets = 0;  // not forgiven yet
  Clock::time_point last_reset = last_use;
};

Connections::Connections(const Limits& limits, spdlog::logger& log)
    : limits_(limits), log_(log), unknown_(std::make_shared<Connection>()) {
  unknown_->ended = true;
}

Connections::Handle Connections::Open(int descriptor, int socket) {
  auto connection = std::make_shared<Connection>();
  connection->peer = "fd:" + std::to_string(descriptor);
  connection->socket = socket;
  const std::lock_guard lock(mutex_);
  connection->kept_only = static_cast<int>(by_peer_.size()) >= limits_.connections;
  by_peer_[connection->peer] = connection;
  return connection;
}

void Connections::Close(const Handle& connection) {
  const std::lock_guard lock(mutex_);
  End(connection);
  connection->socket = -1;
}

bool Connections::Full() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(by_peer_.size()) >= limits_.connections + kReservedConnections;
}

void Connections::EndLongestIdle() {
  const std::lock_guard lock(mutex_);
  Handle longest;
  for (const auto& [peer, connection] : by_peer_) {
    if (connection->unfinished > 0) continue;
    if (longest == nullptr || connection->last_use < longest->last_use) longest = connection;
  }
  if (longest != nullptr && Clock::now() - longest->last_use >= kShortestIdle) End(longest);
}

void Connections::EndSilent() {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  std::vector<Handle> silent;
  for (const auto& [peer, connection] : by_peer_) {
    if (connection->calls == 0 && now - connection->last_use >= limits_.silent_connection) silent.push_back(connection);
  }
  for (const Handle& connection : silent) End(connection);
  silent_ += static_cast<int>(silent.size());
  if ((flooding_ == 0 && silent_ == 0) || now - last_line_ < std::chrono::seconds(10)) return;
  last_line_ = now;
  if (flooding_ > 0) log_.warn("{} connections ended: they reset calls or started too many", flooding_);
  if (silent_ > 0) log_.info("{} connections ended: they made no call", silent_);
  flooding_ = silent_ = 0;
}

Connections::Handle Connections::BeginCall(const std::string& peer) {
  const std::lock_guard lock(mutex_);
  Handle connection = Find(peer);
  ++unfinished_;
  ++connection->unfinished;
  ++connection->calls;
  connection->last_use = Clock::now();
  const int most = unfinished_ > kManyUnfinished ? kMostUnfinishedOfMany : kMostUnfinished;
  if (connection->unfinished > most) EndFlood(connection);
  return connection;
}

void Connections::NoteReset(const Handle& connection) {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  const double forgiven = kResetsPerSecond * std::chrono::duration<double>(now - connection->last_reset).count();
  connection->resets = std::max(0.0, connection->resets - forgiven) + 1;
  connection->last_reset = now;
  if (connection->resets > kMostResets) EndFlood(connection);
}

void Connections::EndCall(const Handle& connection) {
  const std::lock_guard lock(mutex_);
  --unfinished_;
  --connection->unfinished;
  connection->last_use = Clock::now();
}

Connections::Entry Connections::Enter(const std::string& peer, CallKind kind) {
  const std::lock_guard lock(mutex_);
  const Handle connection = Find(peer);
  if (connection->ended) return {nullptr, Unavailable("CONNECTION_ENDED", "the connection was ended", {})};
  if (connection->kept_only && kind != CallKind::kKept) return {nullptr, NoConnectionLeft(limits_.connections)};
  const CallLimit& limit = LimitOf(limits_, kind);
  const std::size_t i = IndexOf(kind);
  if (connection->used[i] >= limit.of_connection) return {nullptr, NoneLeftOfConnection(kind, limit.of_connection)};
  if (used_[i] >= limit.in_all) return {nullptr, NoneLeft(kind, limit.in_all)};
  ++connection->used[i];
  ++used_[i];
  if (kind == CallKind::kUpload) {
    setsockopt(connection->socket, SOL_SOCKET, SO_RCVBUF, &kUploadBuffer, sizeof kUploadBuffer);
  }
  const auto leave = [this, connection, i](void*) {
    const std::lock_guard leaving(mutex_);
    --connection->used[i];
    --used_[i];
  };
  return {Place(connection.get(), leave), grpc::Status::OK};
}

Connections::Handle Connections::Find(const std::string& peer) const {
  const auto found = by_peer_.find(peer);
  return found != by_peer_.end() ? found->second : unknown_;
}

void Connections::End(const Handle& connection) {
  connection->ended = true;
  if (connection->socket >= 0) {
    shutdown(connection->socket, SHUT_RDWR);
    while (recv(connection->socket, nullptr, 1 << 24, MSG_TRUNC | MSG_DONTWAIT) > 0) {  // what gRPC would still read
    }
  }
  // Another one may have the name by now: gRPC has closed its descriptor.
  const auto found = by_peer_.find(connection->peer);
  if (found != by_peer_.end() && found->second == connection) by_peer_.erase(found);
}

void Connections::EndFlood(const Handle& connection) {
  if (connection->ended) return;
  End(connection);
  ++flooding_;
}

}  // namespace fascicle::server
