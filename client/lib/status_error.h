#ifndef FASCICLE_CLIENT_LIB_STATUS_ERROR_H_
#define FASCICLE_CLIENT_LIB_STATUS_ERROR_H_

#include <chrono>
#include <string>
#include <string_view>

#include <grpcpp/support/status.h>

#include "client/lib/client.h"

namespace fascicle::client {

// Converts a failed call to an Error, with the google.rpc details sent by the server. `address` is mentioned if no
// server responded.
Error ErrorOf(const grpc::Status& status, const std::string& address);

// The field of a scene for a field of a request: the server refers to those, users know their scene.
std::string ScenePath(std::string_view field);

// Whether the same call may succeed later: the connection was lost, or the server is starting, stopping or overloaded.
bool IsTransient(const grpc::Status& status);
// Like IsTransient, for streams, which have more ways to break.
bool IsLostStream(const grpc::Status& status);

// The least delay requested by RetryInfo; zero without one.
std::chrono::milliseconds RetryDelayOf(const grpc::Status& status);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_STATUS_ERROR_H_
