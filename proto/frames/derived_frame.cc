#include "proto/frames/derived_frame.h"

#include <zstd.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/base/digest.h"
#include "proto/frames/pack_array.h"

namespace fascicle {
namespace {

using Request = v1::StreamFramesRequest;

constexpr int kLevel = 3;  // of zstd: its default

// Whether numbers are left out or rounded.
bool ChangesNumbers(const Request& request) {
  return request.fields_size() > 0 || request.encoding() == Request::ENCODING_FLOAT32 ||
         request.encoding() == Request::ENCODING_QUANTIZED16;
}

bool Wants(const Request& request, const std::string& part) {
  const auto& fields = request.fields();
  return fields.empty() || std::find(fields.begin(), fields.end(), part) != fields.end();
}

void Select(const Request& request, v1::Frame& frame) {
  if (!Wants(request, kSeriesPart)) frame.clear_series();
  for (v1::BodyFrame& body : *frame.mutable_bodies()) {
    if (!Wants(request, kPositionsPart)) {
      body.clear_positions();
      body.clear_higher_order_positions();
    }
    auto& fields = *body.mutable_fields();
    fields.erase(std::remove_if(fields.begin(), fields.end(),
                                [&](const v1::FieldValues& field) { return !Wants(request, field.name()); }),
                 fields.end());
  }
}

// Empties `doubles` if they can be packed.
std::optional<v1::PackedArray> Pack(std::string& doubles, int components, bool quantized) {
  if (doubles.empty()) return std::nullopt;
  std::optional<v1::PackedArray> packed;
  if (quantized) packed = PackQuantized16(doubles, components);
  if (!packed) packed = PackFloat32(doubles, components);
  if (packed) std::string().swap(doubles);  // gives its memory back
  return packed;
}

// Returns the bound of the error of positions [m].
double PackBody(v1::BodyFrame& body, bool quantized) {
  double error = 0;
  if (auto packed = Pack(*body.mutable_positions(), 3, quantized)) {
    error = std::max(error, packed->max_error());
    *body.mutable_packed_positions() = *std::move(packed);
  }
  if (auto packed = Pack(*body.mutable_higher_order_positions(), 3, quantized)) {
    error = std::max(error, packed->max_error());
    *body.mutable_packed_higher_order_positions() = *std::move(packed);
  }
  for (v1::FieldValues& field : *body.mutable_fields()) {
    if (auto packed = Pack(*field.mutable_values(), field.components(), false)) {
      *field.mutable_packed_values() = *std::move(packed);
    }
    if (auto packed = Pack(*field.mutable_all_values(), field.components(), false)) {
      *field.mutable_packed_all_values() = *std::move(packed);
    }
  }
  return error;
}

std::string Reduced(std::string stored, const Request& request) {
  v1::Frame frame;
  if (!frame.ParseFromString(stored)) throw std::runtime_error("a stored frame can't be read");
  std::string().swap(stored);
  Select(request, frame);
  double error = 0;
  if (request.encoding() == Request::ENCODING_FLOAT32 || request.encoding() == Request::ENCODING_QUANTIZED16) {
    for (v1::BodyFrame& body : *frame.mutable_bodies()) {
      error = std::max(error, PackBody(body, request.encoding() == Request::ENCODING_QUANTIZED16));
    }
  }
  v1::Derivation& derivation = *frame.mutable_derivation();
  derivation.set_stored_digest(frame.digest());
  *derivation.mutable_fields() = request.fields();
  derivation.set_position_error(error);
  frame.clear_digest();
  return frame.SerializeAsString();
}

std::string Compressed(const std::string& bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kLevel);
  if (ZSTD_isError(size) != 0) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
  packed.resize(size);
  packed.shrink_to_fit();
  return packed;
}

std::string DigestText(const std::string& bytes) {
  const Digest digest = Sha256Of(bytes);
  return std::string(digest.begin(), digest.end());
}

std::runtime_error Damaged() { return std::runtime_error("the server sent a frame that is damaged"); }

// Grows with what comes out, so that a false size costs nothing. Throws if there is more than `size`.
std::string Decompressed(const std::string& packed, std::size_t size) {
  constexpr std::size_t kPiece = 1 << 20;
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  if (context == nullptr) throw std::bad_alloc();
  std::string bytes;
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  std::size_t left = 1;  // zero at the end of the zstd frame
  while (left != 0) {
    const std::size_t before = bytes.size();
    if (before > size) throw Damaged();
    bytes.resize(before + std::min(kPiece, size - before + 1));
    ZSTD_outBuffer out{bytes.data() + before, bytes.size() - before, 0};
    left = ZSTD_decompressStream(context.get(), &out, &in);
    bytes.resize(before + out.pos);
    if (ZSTD_isError(left) != 0 || (left != 0 && out.pos == 0 && in.pos == in.size)) throw Damaged();
  }
  if (in.pos != in.size) throw Damaged();
  return bytes;
}

void Restore(const v1::PackedArray& packed, std::string& doubles) {
  if (!doubles.empty()) throw std::runtime_error("the server sent numbers twice");
  doubles = Unpack(packed);
}

void RestoreBody(v1::BodyFrame& body) {
  if (body.has_packed_positions()) Restore(body.packed_positions(), *body.mutable_positions());
  body.clear_packed_positions();
  if (body.has_packed_higher_order_positions()) {
    Restore(body.packed_higher_order_positions(), *body.mutable_higher_order_positions());
  }
  body.clear_packed_higher_order_positions();
  for (v1::FieldValues& field : *body.mutable_fields()) {
    if (field.has_packed_values()) Restore(field.packed_values(), *field.mutable_values());
    field.clear_packed_values();
    if (field.has_packed_all_values()) Restore(field.packed_all_values(), *field.mutable_all_values());
    field.clear_packed_all_values();
  }
}

}  // namespace

bool AsksForDerived(const Request& request) {
  return ChangesNumbers(request) || request.compression() != v1::DerivedFrame::COMPRESSION_UNSPECIFIED;
}

v1::DerivedFrame DeriveFrame(std::string stored, const Request& request) {
  std::string content = ChangesNumbers(request) ? Reduced(std::move(stored), request) : std::move(stored);
  v1::DerivedFrame derived;
  derived.set_content_digest(DigestText(content));
  derived.set_content_size(static_cast<std::int64_t>(content.size()));
  derived.set_compression(request.compression());
  derived.set_content(request.compression() == v1::DerivedFrame::COMPRESSION_ZSTD ? Compressed(content)
                                                                                  : std::move(content));
  return derived;
}

v1::Frame ReadDerivedFrame(const v1::DerivedFrame& derived) {
  if (derived.content_size() < 0 || derived.content_size() > kLargestDerived) {
    throw std::runtime_error("the server sent a frame of an impossible size");
  }
  if (derived.compression() != v1::DerivedFrame::COMPRESSION_UNSPECIFIED &&
      derived.compression() != v1::DerivedFrame::COMPRESSION_ZSTD) {
    throw std::runtime_error("the server sent a frame with a compression that this program does not know");
  }
  const auto size = static_cast<std::size_t>(derived.content_size());
  std::string unpacked;
  if (derived.compression() == v1::DerivedFrame::COMPRESSION_ZSTD) unpacked = Decompressed(derived.content(), size);
  const std::string& content =
      derived.compression() == v1::DerivedFrame::COMPRESSION_ZSTD ? unpacked : derived.content();
  if (content.size() != size || DigestText(content) != derived.content_digest()) throw Damaged();
  v1::Frame frame;
  if (!frame.ParseFromString(content)) throw Damaged();
  for (v1::BodyFrame& body : *frame.mutable_bodies()) RestoreBody(body);
  return frame;
}

}  // namespace fascicle
