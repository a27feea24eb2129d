#ifndef FASCICLE_SERVER_RPC_CHUNK_MESSAGE_H_
#define FASCICLE_SERVER_RPC_CHUNK_MESSAGE_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include <grpcpp/support/byte_buffer.h>

#include <google/protobuf/message_lite.h>

namespace fascicle::server {

// A part of a serialized message: `size` bytes of `bytes`, starting at `begin`.
struct ChunkSource {
  std::int64_t frame_index = 0;
  std::int64_t offset = 0;  // within the message [byte]
  bool last = false;
  std::shared_ptr<const std::string> bytes;
  std::size_t begin = 0;
  std::size_t size = 0;
};

// A serialized message whose field number `field` is the v1::Chunk made of `source`, with its CRC-32C. The data is not
// copied: the buffer shares ownership of `source.bytes`. Serializing a v1::Chunk would copy each byte twice more.
grpc::ByteBuffer ChunkMessage(int field, const ChunkSource& source);

grpc::ByteBuffer Serialize(const google::protobuf::MessageLite& message);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_RPC_CHUNK_MESSAGE_H_
