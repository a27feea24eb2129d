#ifndef FASCICLE_SERVER_RPC_RAW_REQUEST_H_
#define FASCICLE_SERVER_RPC_RAW_REQUEST_H_

#include <optional>

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/proto_buffer_reader.h>
#include <grpcpp/support/server_callback.h>

#include "server/rpc/errors.h"

namespace fascicle::server {

// Calls whose messages are bytes for gRPC: their requests, and answers without a stream.

// A stream that ends at once with a status.
class EndedStream : public grpc::ServerWriteReactor<grpc::ByteBuffer> {
 public:
  explicit EndedStream(const grpc::Status& status) { Finish(status); }
  void OnDone() override { delete this; }
};

// The message of a request; nothing if the bytes are not one.
template <class Message>
std::optional<Message> ParseRequest(const grpc::ByteBuffer& bytes) {
  grpc::ByteBuffer copy(bytes);  // shares the bytes; parsing consumes it
  Message message;
  if (!grpc::SerializationTraits<Message>::Deserialize(&copy, &message).ok()) return std::nullopt;
  return message;
}

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_RAW_REQUEST_H_
