#ifndef FASCICLE_CORE_IMAGING_UNPACK_H_
#define FASCICLE_CORE_IMAGING_UNPACK_H_

#include <cstdint>
#include <stop_token>
#include <string>
#include <string_view>

#include "core/base/problems.h"

// Internal to this room.
namespace fascicle {

enum class Compression { kGzipOrZlib, kDeflateOnly, kBzip2 };

// Appends the bytes that are packed in one or several streams to `out`, up to `most` of them, and checks the streams to
// their ends, checksums included. What follows the last stream is left. Returns false and adds a problem if a stream is
// incomplete or damaged. Throws Stopped after a stop request.
bool Unpack(Compression compression, std::string_view packed, std::uint64_t most, std::string& out,
            const std::stop_token& stop, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_UNPACK_H_
