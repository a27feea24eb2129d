#ifndef FASCICLE_CLIENT_CLI_DIGESTS_H_
#define FASCICLE_CLIENT_CLI_DIGESTS_H_

#include "fascicle/v1/frame.pb.h"

namespace fascicle::client {

// Prints the frame's index, time and SHA-256 as a line, or as a JSON object, to stdout. Throws std::runtime_error if
// that is not the digest of the frame's numbers.
void PrintDigest(const v1::Frame& frame, bool json);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_DIGESTS_H_
