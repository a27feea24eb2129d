#ifndef FASCICLE_CLIENT_LIB_MESSAGE_ASSEMBLER_H_
#define FASCICLE_CLIENT_LIB_MESSAGE_ASSEMBLER_H_

#include <cstdint>
#include <string>

#include "fascicle/v1/simulation_service.pb.h"

namespace fascicle::client {

// Joins the chunks of a message that was sent in parts.
class MessageAssembler {
 public:
  enum class State { kMore, kComplete, kBroken };

  // kBroken when the chunk does not follow the ones before or its checksum is wrong. Takes its data.
  State Add(v1::Chunk& chunk);
  // The index that the chunks of the message carry.
  std::int64_t frame_index() const { return frame_index_; }
  // After kComplete: the bytes; ready for the next message.
  std::string Take();

 private:
  std::int64_t frame_index_ = 0;
  std::string bytes_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_MESSAGE_ASSEMBLER_H_
