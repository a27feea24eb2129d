#ifndef FASCICLE_SERVER_RPC_LISTENER_H_
#define FASCICLE_SERVER_RPC_LISTENER_H_

#include <map>
#include <string>
#include <thread>
#include <vector>

#include <grpcpp/server.h>
#include <spdlog/logger.h>

#include "server/rpc/connections.h"

namespace fascicle::server {

// Accepts connections and hands them to gRPC. gRPC 1.51's own listener stops for good when the process has no file
// descriptors left, and cannot end a connection. Not thread-safe.
class Listener {
 public:
  // Listens on "HOST:PORT"; port 0 chooses a free one. Throws std::runtime_error if it cannot.
  explicit Listener(const std::string& address);
  // Stops.
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  int port() const { return port_; }
  // Accepts on a thread of its own. The arguments must outlive Stop.
  void Start(grpc::Server& server, Connections& connections, spdlog::logger& log);
  // Closes the port; open connections stay. Idempotent.
  void Stop();

 private:
  void Run();
  // Accepts what waits at `socket`. False if there are no descriptors left.
  bool AcceptAll(int socket);
  void Accepted(int descriptor);
  void Watch(int descriptor, unsigned events) const;

  std::vector<int> sockets_;
  int port_ = 0;
  int epoll_ = -1;
  int stop_ = -1;  // an eventfd
  std::map<int, Connections::Handle> open_;
  grpc::Server* server_ = nullptr;
  Connections* connections_ = nullptr;
  spdlog::logger* log_ = nullptr;
  std::thread thread_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_LISTENER_H_
