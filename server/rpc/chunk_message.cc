#include "server/rpc/chunk_message.h"

#include <array>
#include <string_view>

#include "core/base/digest.h"
#include "fascicle/v1/simulation_service.pb.h"

namespace fascicle::server {
namespace {

void AppendVarint(std::string& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<char>(value | 0x80));
  out.push_back(static_cast<char>(value));
}

// Appends tag and length of a length-delimited field.
void AppendField(std::string& out, int field, std::size_t length) {
  AppendVarint(out, static_cast<std::uint64_t>(field) << 3 | 2);
  AppendVarint(out, length);
}

using Holder = std::shared_ptr<const std::string>;

grpc::Slice SliceOf(const Holder& bytes, std::size_t begin, std::size_t size) {
  auto* holder = new Holder(bytes);
  const auto release = [](void* h) { delete static_cast<Holder*>(h); };
  return grpc::Slice(const_cast<char*>(bytes->data()) + begin, size, release, holder);
}

}  // namespace

grpc::ByteBuffer ChunkMessage(int field, const ChunkSource& source) {
  v1::Chunk chunk;
  chunk.set_frame_index(source.frame_index);
  chunk.set_offset(source.offset);
  chunk.set_last(source.last);
  chunk.set_crc32c(Crc32c(std::string_view(*source.bytes).substr(source.begin, source.size)));
  std::string inner = chunk.SerializeAsString();
  AppendField(inner, v1::Chunk::kDataFieldNumber, source.size);  // protobuf accepts fields in any order
  std::string head;
  AppendField(head, field, inner.size() + source.size);
  head += inner;
  const std::array slices = {grpc::Slice(head), SliceOf(source.bytes, source.begin, source.size)};
  return grpc::ByteBuffer(slices.data(), slices.size());
}

grpc::ByteBuffer Serialize(const google::protobuf::MessageLite& message) {
  const grpc::Slice slice(message.SerializeAsString());
  return grpc::ByteBuffer(&slice, 1);
}

}  // namespace fascicle::server
