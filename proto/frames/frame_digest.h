#ifndef FASCICLE_PROTO_FRAMES_FRAME_DIGEST_H_
#define FASCICLE_PROTO_FRAMES_FRAME_DIGEST_H_

#include <string>

#include "fascicle/v1/frame.pb.h"

namespace fascicle {

// What `Frame.digest` of these numbers must be: 32 bytes.
std::string DigestOfNumbers(const v1::Frame& frame);

}  // namespace fascicle

#endif  // FASCICLE_PROTO_FRAMES_FRAME_DIGEST_H_
