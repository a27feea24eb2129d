#ifndef FASCICLE_PROTO_FRAMES_PACK_ARRAY_H_
#define FASCICLE_PROTO_FRAMES_PACK_ARRAY_H_

#include <optional>
#include <string>
#include <string_view>

#include "fascicle/v1/frame.pb.h"

namespace fascicle {

// Numbers of frames in fewer bits. Arrays are little-endian doubles, component fastest.

// In single precision, with the bound of the error. Nothing if a number is beyond its range, or if `doubles` is not a
// whole number of tuples.
std::optional<v1::PackedArray> PackFloat32(std::string_view doubles, int components);

// In 16 bit between the lowest and the highest number of each component, with the bound of the error. Nothing if a
// number is not finite, if the differences overflow, or if `doubles` is not a whole number of tuples.
std::optional<v1::PackedArray> PackQuantized16(std::string_view doubles, int components);

// The doubles of a packed array. Throws std::runtime_error, with a message for users, if it is malformed.
std::string Unpack(const v1::PackedArray& array);

}  // namespace fascicle

#endif  // FASCICLE_PROTO_FRAMES_PACK_ARRAY_H_
