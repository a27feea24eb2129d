#ifndef FASCICLE_PROTO_FRAMES_DERIVED_FRAME_H_
#define FASCICLE_PROTO_FRAMES_DERIVED_FRAME_H_

#include <cstdint>
#include <string>

#include "fascicle/v1/frame.pb.h"
#include "fascicle/v1/simulation_service.pb.h"

namespace fascicle {

// Frames with some of their parts, in another encoding, or compressed. The server derives them, clients read them.
// Thread-safe.

// Names of parts of frames, beside those of fields.
inline constexpr const char* kPositionsPart = "positions";
inline constexpr const char* kSeriesPart = "series";

// Largest serialized frame that can be derived from, and read [byte].
inline constexpr std::int64_t kLargestDerived = std::int64_t{512} << 20;

// Whether a request asks for derived frames.
bool AsksForDerived(const v1::StreamFramesRequest& request);

// What the request asks for of a serialized v1::Frame. Equal arguments give equal bytes. Throws std::runtime_error if
// `stored` is not a frame.
v1::DerivedFrame DeriveFrame(std::string stored, const v1::StreamFramesRequest& request);

// The frame with arrays of doubles again. Its `digest` is empty if its numbers are not those that are stored; then it
// has a `derivation`. Throws std::runtime_error, with a message for users, if it is damaged or malformed.
v1::Frame ReadDerivedFrame(const v1::DerivedFrame& derived);

}  // namespace fascicle

#endif  // FASCICLE_PROTO_FRAMES_DERIVED_FRAME_H_
