#ifndef FASCICLE_SERVER_RPC_CALL_WATCH_H_
#define FASCICLE_SERVER_RPC_CALL_WATCH_H_

#include <memory>
#include <vector>

#include <grpcpp/support/server_interceptor.h>

#include "server/rpc/connections.h"

namespace fascicle::server {

// Interceptors of a server that count the calls of `connections`, of all services, and give errors of gRPC itself an
// ErrorInfo. `connections` must outlive all calls.
std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> WatchCalls(
    Connections& connections);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_CALL_WATCH_H_
