#ifndef FASCICLE_CLIENT_LIB_STATUS_ERROR_H_
#define FASCICLE_CLIENT_LIB_STATUS_ERROR_H_

#include <chrono>
#include <string>

#include <grpcpp/support/status.h>

#include "client/lib/client.h"

namespace fascicle::client {

// What a failed call means to a user: the status with the google.rpc details that the server packed into it.
// `address` is named where no server answered.
Error ErrorOf(const grpc::Status& status, const std::string& address);

// Whether the same call may succeed later: the connection was lost, or the server is starting, stopping or overloaded.
bool IsTransient(const grpc::Status& status);
// As IsTransient for streams, which break in more ways.
bool IsLostStream(const grpc::Status& status);

// What RetryInfo asks to wait at least; zero without one.
std::chrono::milliseconds RetryDelayOf(const grpc::Status& status);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_STATUS_ERROR_H_
