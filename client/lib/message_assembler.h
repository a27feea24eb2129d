#ifndef FASCICLE_CLIENT_LIB_MESSAGE_ASSEMBLER_H_
#define FASCICLE_CLIENT_LIB_MESSAGE_ASSEMBLER_H_

#include <cstdint>
#include <string>

#include "fascicle/v1/simulation_service.pb.h"

namespace fascicle::client {

// Reassembles a message from its chunks.
class MessageAssembler {
 public:
  enum class State { kMore, kComplete, kBroken };

  // kBroken if the chunk does not follow the previous ones or its checksum is wrong. Consumes its data.
  State Add(v1::Chunk& chunk);
  // The frame index given by the chunks of the message.
  std::int64_t frame_index() const { return frame_index_; }
  // After kComplete: returns the bytes and gets ready for the next message.
  std::string Take();

 private:
  std::int64_t frame_index_ = 0;
  std::string bytes_;
};

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_LIB_MESSAGE_ASSEMBLER_H_
