#include <array>
#include <bit>
#include <cstring>

#include "core/base/digest.h"

#if defined(__x86_64__)
#include <nmmintrin.h>
#endif

// CRC-32C: polynomial 0x1EDC6F41, reflected, all ones before and after [RFC 3720, B.4].
namespace fascicle {
namespace {

static_assert(std::endian::native == std::endian::little);

// crc after one more byte: (crc >> 8) ^ kByteTable[(crc ^ byte) & 255].
constexpr std::array<std::uint32_t, 256> kByteTable = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t crc = i;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) ? 0x82F63B78u : 0u);
    table[i] = crc;
  }
  return table;
}();

std::uint32_t ExtendByTable(const char* data, std::size_t size, std::uint32_t crc) {
  for (std::size_t i = 0; i < size; ++i)
    crc = (crc >> 8) ^ kByteTable[(crc ^ static_cast<std::uint8_t>(data[i])) & 255];
  return crc;
}

#if defined(__x86_64__)

// The CRC instruction accepts one word per cycle and has a latency of three cycles, so three stretches of the input are
// processed side by side.
constexpr std::size_t kStretch = 1024;
static_assert(kStretch % 8 == 0);

// kAppendZeros[k][b]: the CRC of byte b at position k followed by kStretch zero bytes. A CRC is linear in its bits, so
// the contributions of the four bytes add up.
constexpr std::array<std::array<std::uint32_t, 256>, 4> kAppendZeros = [] {
  std::array<std::uint32_t, 32> of_bit{};
  for (int bit = 0; bit < 32; ++bit) {
    std::uint32_t crc = 1u << bit;
    for (std::size_t i = 0; i < kStretch; ++i) crc = (crc >> 8) ^ kByteTable[crc & 255];
    of_bit[bit] = crc;
  }
  std::array<std::array<std::uint32_t, 256>, 4> tables{};
  for (int k = 0; k < 4; ++k) {
    for (int byte = 0; byte < 256; ++byte) {
      for (int bit = 0; bit < 8; ++bit) {
        if (byte >> bit & 1) tables[k][byte] ^= of_bit[8 * k + bit];
      }
    }
  }
  return tables;
}();

std::uint32_t AppendZeros(std::uint32_t crc) {
  return kAppendZeros[0][crc & 255] ^ kAppendZeros[1][crc >> 8 & 255] ^ kAppendZeros[2][crc >> 16 & 255] ^
         kAppendZeros[3][crc >> 24];
}

std::uint64_t Word(const char* data) {
  std::uint64_t word;
  std::memcpy(&word, data, sizeof(word));
  return word;
}

__attribute__((target("sse4.2"))) std::uint32_t ExtendBySse42(const char* data, std::size_t size, std::uint32_t crc) {
  while (size >= 3 * kStretch) {
    std::uint64_t first = crc, second = 0, third = 0;
    for (std::size_t i = 0; i < kStretch; i += 8) {
      first = _mm_crc32_u64(first, Word(data + i));
      second = _mm_crc32_u64(second, Word(data + kStretch + i));
      third = _mm_crc32_u64(third, Word(data + 2 * kStretch + i));
    }
    crc = AppendZeros(static_cast<std::uint32_t>(first)) ^ static_cast<std::uint32_t>(second);
    crc = AppendZeros(crc) ^ static_cast<std::uint32_t>(third);
    data += 3 * kStretch;
    size -= 3 * kStretch;
  }
  std::uint64_t wide = crc;
  for (; size >= 8; data += 8, size -= 8) wide = _mm_crc32_u64(wide, Word(data));
  crc = static_cast<std::uint32_t>(wide);
  for (; size > 0; ++data, --size) crc = _mm_crc32_u8(crc, static_cast<std::uint8_t>(*data));
  return crc;
}

#endif

}  // namespace

std::uint32_t Crc32cByTable(std::string_view bytes, std::uint32_t crc) {
  return ~ExtendByTable(bytes.data(), bytes.size(), ~crc);
}

std::uint32_t Crc32c(std::string_view bytes, std::uint32_t crc) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("sse4.2")) return ~ExtendBySse42(bytes.data(), bytes.size(), ~crc);
#endif
  return Crc32cByTable(bytes, crc);
}

}  // namespace fascicle
