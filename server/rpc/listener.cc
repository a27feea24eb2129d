#include "server/rpc/listener.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string_view>

#include <grpcpp/server_posix.h>

namespace fascicle::server {
namespace {

constexpr int kBacklog = 1024;
// Bytes that may wait for gRPC (the kernel doubles it). gRPC 1.51 reads all calls that are there before it works on
// any: 100,000 of them in a second were 15 s of work that everybody waited for, and 1.2 GB. Uploads get more
// (Connections).
constexpr int kReceiveBuffer = 16 << 10;

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

// The addresses of "HOST:PORT" or "[HOST]:PORT".
Addresses Resolve(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  std::string host = address.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  addrinfo hints = {};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), address.substr(colon + 1).c_str(), &hints, &found) != 0) found = nullptr;
  return {found, &freeaddrinfo};
}

void SetPort(sockaddr& address, int port) {
  const in_port_t network = htons(static_cast<in_port_t>(port));
  if (address.sa_family == AF_INET) reinterpret_cast<sockaddr_in&>(address).sin_port = network;
  if (address.sa_family == AF_INET6) reinterpret_cast<sockaddr_in6&>(address).sin6_port = network;
}

int PortOf(int socket) {
  sockaddr_storage address = {};
  socklen_t size = sizeof address;
  if (getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) return 0;
  return ntohs(address.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(address).sin6_port
                                             : reinterpret_cast<sockaddr_in&>(address).sin_port);
}

// A socket that listens there; negative if that is not possible. SO_REUSEPORT stays off: a second server on the same
// port would receive half of the calls.
int ListenOn(const addrinfo& info) {
  const int found = socket(info.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (found < 0) return -1;
  const int on = 1;
  setsockopt(found, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (info.ai_family == AF_INET6) setsockopt(found, IPPROTO_IPV6, IPV6_V6ONLY, &on, sizeof on);
  if (bind(found, info.ai_addr, info.ai_addrlen) == 0 && listen(found, kBacklog) == 0) return found;
  close(found);
  return -1;
}

// Tells a client that its connection is refused: empty SETTINGS, then GOAWAY with ENHANCE_YOUR_CALM and a text.
void Refuse(int socket) {
  constexpr std::string_view kText = "the server has all the connections that it allows";
  std::string bytes("\0\0\0\4\0\0\0\0\0", 9);
  bytes += std::string("\0\0", 2) + static_cast<char>(8 + kText.size()) + std::string("\7\0\0\0\0\0", 6);
  bytes += std::string("\0\0\0\0\0\0\0\xb", 8);
  bytes += kText;
  send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  shutdown(socket, SHUT_WR);
}

}  // namespace

Listener::Listener(const std::string& address) {
  const Addresses addresses = Resolve(address);
  for (addrinfo* info = addresses.get(); info != nullptr; info = info->ai_next) {
    if (port_ != 0) SetPort(*info->ai_addr, port_);  // all addresses of a name have the same port
    const int socket = ListenOn(*info);
    if (socket < 0) continue;
    sockets_.push_back(socket);
    port_ = PortOf(socket);
  }
  if (sockets_.empty()) {
    throw std::runtime_error("cannot listen on " + address +
                             ": the address does not belong to this machine or the port is in use");
  }
  epoll_ = epoll_create1(EPOLL_CLOEXEC);
  stop_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (epoll_ < 0 || stop_ < 0) throw std::runtime_error("there are no file descriptors left");
  Watch(stop_, EPOLLIN);
  for (const int socket : sockets_) Watch(socket, EPOLLIN);
}

Listener::~Listener() { Stop(); }

void Listener::Start(grpc::Server& server, Connections& connections, spdlog::logger& log) {
  server_ = &server;
  connections_ = &connections;
  log_ = &log;
  thread_ = std::thread([this] { Run(); });
}

void Listener::Stop() {
  if (stop_ < 0) return;
  eventfd_write(stop_, 1);
  if (thread_.joinable()) thread_.join();
  for (const auto& [socket, connection] : open_) {
    connections_->Close(connection);
    close(socket);
  }
  open_.clear();
  for (const int socket : sockets_) close(socket);
  close(epoll_);
  close(stop_);
  epoll_ = stop_ = -1;
}

void Listener::Watch(int descriptor, unsigned events) const {
  epoll_event event = {};
  event.events = events;
  event.data.fd = descriptor;
  epoll_ctl(epoll_, EPOLL_CTL_ADD, descriptor, &event);
}

void Listener::Run() {
  constexpr std::chrono::seconds kSweep(1);
  auto next_sweep = std::chrono::steady_clock::now() + kSweep;
  bool starved = false;  // of descriptors
  while (true) {
    std::array<epoll_event, 64> events;
    const int count = epoll_wait(epoll_, events.data(), static_cast<int>(events.size()), 1000);
    bool accepted = true;
    for (int i = 0; i < count; ++i) {
      const int ready = events[static_cast<std::size_t>(i)].data.fd;
      if (ready == stop_) return;
      if (const auto found = open_.find(ready); found != open_.end()) {  // both directions are shut
        connections_->Close(found->second);
        // While gRPC still has the connection open, epoll would go on to report it under a number that is used again.
        epoll_ctl(epoll_, EPOLL_CTL_DEL, ready, nullptr);
        close(ready);
        open_.erase(found);
      } else {
        accepted = AcceptAll(ready) && accepted;
      }
    }
    if (!accepted) {
      if (!starved) log_->error("no file descriptors left: new clients wait");
      connections_->EndLongestIdle();
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    starved = !accepted;
    if (std::chrono::steady_clock::now() < next_sweep) continue;
    connections_->EndSilent();
    next_sweep = std::chrono::steady_clock::now() + kSweep;
  }
}

bool Listener::AcceptAll(int socket) {
  while (true) {
    const int descriptor = accept4(socket, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (descriptor >= 0) {
      Accepted(descriptor);
    } else if (errno != EINTR && errno != ECONNABORTED) {
      return errno != EMFILE && errno != ENFILE && errno != ENOBUFS && errno != ENOMEM;
    }
  }
}

void Listener::Accepted(int descriptor) {
  if (connections_->Full()) connections_->EndLongestIdle();
  const int own = connections_->Full() ? -1 : fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
  if (own < 0) {
    Refuse(descriptor);
    close(descriptor);
    return;
  }
  const int on = 1;
  setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &kReceiveBuffer, sizeof kReceiveBuffer);
  open_[own] = connections_->Open(descriptor, own);
  Watch(own, 0);  // errors and the end of both directions
  grpc::AddInsecureChannelFromFd(server_, descriptor);
}

}  // namespace fascicle::server
