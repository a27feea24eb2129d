#ifndef FASCICLE_SERVER_EMBEDDED_SERVER_H_
#define FASCICLE_SERVER_EMBEDDED_SERVER_H_

#include <memory>
#include <string>

namespace fascicle::server {

struct ServerOptions {
  std::string listen = "127.0.0.1:0";  // port 0 picks a free one
  std::string data_directory;          // empty: in memory
  int workers = 2;
  int default_threads = 1;
  bool allow_remote = false;           // refuses other addresses than loopback when false
};

// A whole server in this process: `fascicled` and `fascicle run` are thin layers over it.
class EmbeddedServer {
 public:
  // Listens when it returns. Throws std::runtime_error with a message for people.
  static std::unique_ptr<EmbeddedServer> Start(const ServerOptions& options);
  virtual ~EmbeddedServer() = default;
  virtual std::string address() const = 0;  // "127.0.0.1:PORT"
  virtual int port() const = 0;
  // Drains: ends every stream with UNAVAILABLE, stops workers with a checkpoint, closes. Idempotent; at most 10 s.
  virtual void Stop() = 0;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_EMBEDDED_SERVER_H_
