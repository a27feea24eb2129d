// Any bytes as a derived frame, as packed numbers and as a stored frame: read, and derived in each form.
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "core/base/check.h"
#include "core/base/digest.h"
#include "proto/frames/derived_frame.h"
#include "proto/frames/pack_array.h"

namespace fascicle {
namespace {

void Read(const std::string& bytes) {
  v1::DerivedFrame derived;
  if (!derived.ParseFromString(bytes)) return;
  try {
    (void)ReadDerivedFrame(derived);
  } catch (const std::runtime_error&) {
    // Digests are rarely right by chance: what is behind them is read with the right one, too.
  }
  if (derived.compression() != v1::DerivedFrame::COMPRESSION_UNSPECIFIED) return;
  const Digest digest = Sha256Of(derived.content());
  derived.set_content_digest(digest.data(), digest.size());
  derived.set_content_size(static_cast<std::int64_t>(derived.content().size()));
  try {
    (void)ReadDerivedFrame(derived);
  } catch (const std::runtime_error&) {
  }
}

void UnpackAny(const std::string& bytes) {
  v1::PackedArray array;
  if (!array.ParseFromString(bytes)) return;
  try {
    FASCICLE_CHECK(Unpack(array).size() <= 4 * array.values().size(), "at most four times as many bytes");
  } catch (const std::runtime_error&) {
  }
}

void Derive(const std::string& bytes) {
  v1::Frame frame;
  if (!frame.ParseFromString(bytes)) return;
  for (const auto encoding :
       {v1::StreamFramesRequest::ENCODING_FLOAT32, v1::StreamFramesRequest::ENCODING_QUANTIZED16}) {
    v1::StreamFramesRequest request;
    request.set_encoding(encoding);
    request.set_compression(v1::DerivedFrame::COMPRESSION_ZSTD);
    const v1::DerivedFrame derived = DeriveFrame(bytes, request);
    try {
      const v1::Frame back = ReadDerivedFrame(derived);
      FASCICLE_CHECK(back.bodies_size() == frame.bodies_size(), "the same bodies");
    } catch (const std::runtime_error&) {
      // A frame that has packed numbers already, which no stored one has.
    }
  }
}

}  // namespace
}  // namespace fascicle

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  fascicle::Read(bytes);
  fascicle::UnpackAny(bytes);
  fascicle::Derive(bytes);
  return 0;
}
