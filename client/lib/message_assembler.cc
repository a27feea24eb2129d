#include "client/lib/message_assembler.h"

#include <utility>

#include "core/base/digest.h"

namespace fascicle::client {

MessageAssembler::State MessageAssembler::Add(v1::Chunk& chunk) {
  const bool first = bytes_.empty();
  if (first) frame_index_ = chunk.frame_index();
  if (chunk.frame_index() != frame_index_ || chunk.offset() != static_cast<std::int64_t>(bytes_.size()) ||
      Crc32c(chunk.data()) != chunk.crc32c()) {
    return State::kBroken;
  }
  if (first) {
    bytes_ = std::move(*chunk.mutable_data());
  } else {
    bytes_ += chunk.data();
  }
  return chunk.last() ? State::kComplete : State::kMore;
}

std::string MessageAssembler::Take() { return std::exchange(bytes_, {}); }

}  // namespace fascicle::client
