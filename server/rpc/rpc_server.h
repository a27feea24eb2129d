#ifndef FASCICLE_SERVER_RPC_RPC_SERVER_H_
#define FASCICLE_SERVER_RPC_RPC_SERVER_H_

#include <memory>
#include <string>

#include <spdlog/logger.h>

#include "server/jobs/job_manager.h"
#include "server/rpc/rpc_context.h"
#include "server/store/store.h"

namespace fascicle::server {

// The services on a port, with health (grpc.health.v1) and reflection.
class RpcServer {
 public:
  // Listens on `listen` ("HOST:PORT"; port 0 chooses a free one). The other arguments must outlive this object. Throws
  // std::runtime_error if it cannot listen there.
  RpcServer(const std::string& listen, Store& store, JobManager& jobs, ResultCache& results,
            std::shared_ptr<spdlog::logger> log, const RpcSettings& settings);
  ~RpcServer();

  int port() const;
  // Reports NOT_SERVING, ends every stream with UNAVAILABLE, then closes the port. Idempotent; waits for calls in
  // progress.
  void Stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_RPC_SERVER_H_
