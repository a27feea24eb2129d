#ifndef FASCICLE_CORE_BASE_DIGEST_H_
#define FASCICLE_CORE_BASE_DIGEST_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace fascicle {

// A SHA-256 digest.
using Digest = std::array<std::uint8_t, 32>;

// Computes the SHA-256 digest of all bytes passed to Update, in pieces of any size. Not thread-safe.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void Update(std::span<const std::byte> bytes);
  void Update(std::string_view bytes) { Update(std::as_bytes(std::span(bytes))); }
  // Ends the computation. Update must not follow.
  Digest Finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

Digest Sha256Of(std::string_view bytes);
// The digest as 64 lower-case hexadecimal digits.
std::string Hex(const Digest& digest);

// CRC-32C (Castagnoli) of `bytes`. `crc` is the CRC of the bytes before them, 0 at the start.
std::uint32_t Crc32c(std::string_view bytes, std::uint32_t crc = 0);
// The same by table, byte by byte, for machines without the CRC instruction.
std::uint32_t Crc32cByTable(std::string_view bytes, std::uint32_t crc = 0);

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_DIGEST_H_
