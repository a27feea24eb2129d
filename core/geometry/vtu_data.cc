#include "core/geometry/vtu_data.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace fascicle {
namespace {

// Meshes compress by a factor of two to ten; much more is a decompression bomb. Without compression, all arrays and the
// headers examined beforehand fit in a few times the file's size, unless many arrays claim the same bytes.
constexpr std::uint64_t kMaxRatioCompressed = 32, kMaxRatioPlain = 4;
constexpr std::uint64_t kAlwaysAllowed = 1 << 20;  // bytes

constexpr std::int8_t kSpace = -1, kBad = -2;

constexpr std::array<std::int8_t, 256> kBase64 = [] {
  std::array<std::int8_t, 256> values{};
  for (std::int8_t& value : values) value = kBad;
  constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::int8_t i = 0; i < 64; ++i) values[static_cast<unsigned char>(kLetters[i])] = i;
  for (const char space : {' ', '\t', '\r', '\n'}) values[static_cast<unsigned char>(space)] = kSpace;
  return values;
}();

// Decodes until `size` bytes are available or the text ends. Padding may occur inside: a header and its data are often
// encoded separately, one after the other.
bool DecodeBase64(std::string_view text, std::size_t size, std::string& data) {
  std::uint32_t bits = 0;
  int letters = 0;
  for (std::size_t i = 0; i < text.size() && data.size() < size; ++i) {
    if (text[i] == '=') {
      if (letters < 2) return false;
      data += static_cast<char>(bits >> (6 * letters - 8));
      if (letters == 3) data += static_cast<char>(bits >> 2);
      if (letters == 2 && (++i == text.size() || text[i] != '=')) return false;
      bits = 0;
      letters = 0;
      continue;
    }
    const std::int8_t value = kBase64[static_cast<unsigned char>(text[i])];
    if (value == kSpace) continue;
    if (value == kBad) return false;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    if (++letters < 4) continue;
    for (const int shift : {16, 8, 0}) data += static_cast<char>(bits >> shift);
    bits = 0;
    letters = 0;
  }
  if (data.size() < size) return false;
  data.resize(size);
  return true;
}

// Upper bound for the bytes that the text can hold. (The length of the text for a given number of bytes is unknown,
// because it may contain white space.)
std::size_t MostBytes(std::string_view text, bool base64) { return base64 ? text.size() / 4 * 3 + 3 : text.size(); }

bool Inflate(std::string_view compressed, std::size_t size, std::string& data) {
  const std::size_t before = data.size();
  data.resize(before + size);
  uLongf there = size;
  const int result = uncompress(reinterpret_cast<Bytef*>(data.data() + before), &there,
                                reinterpret_cast<const Bytef*>(compressed.data()), compressed.size());
  return result == Z_OK && there == size;
}

}  // namespace

VtuDecoder::VtuDecoder(const VtuEncoding& encoding, std::size_t file_size)
    : encoding_(encoding),
      allowance_(kAlwaysAllowed +
                 (encoding.compressed ? kMaxRatioCompressed : kMaxRatioPlain) * std::uint64_t(file_size)) {}

std::optional<std::string> VtuDecoder::Decode(std::string_view text, bool base64) {
  if (base64) text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return encoding_.compressed ? DecodeCompressed(text, base64) : DecodePlain(text, base64);
}

std::optional<std::string> VtuDecoder::Fail(std::string problem) {
  problem_ = std::move(problem);
  return std::nullopt;
}

bool VtuDecoder::Allow(std::uint64_t size) {
  if (size > allowance_) return false;
  allowance_ -= size;
  return true;
}

std::uint64_t VtuDecoder::HeaderWord(std::string_view data, std::size_t index) const {
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < encoding_.header_word; ++i) {
    const std::size_t byte = encoding_.big_endian ? i : encoding_.header_word - 1 - i;
    word = word << 8 | static_cast<unsigned char>(data[index * encoding_.header_word + byte]);
  }
  return word;
}

bool VtuDecoder::Fetch(std::string_view text, bool base64, std::size_t size, std::string& data) {
  data.clear();
  if (size > MostBytes(text, base64) || !Allow(size)) return false;
  if (base64) return DecodeBase64(text, size, data);
  data.assign(text.substr(0, size));
  return true;
}

std::optional<std::string> VtuDecoder::DecodePlain(std::string_view text, bool base64) {
  const std::size_t word = encoding_.header_word;
  std::string data;
  if (!Fetch(text, base64, word, data)) return Fail("has no header");
  const std::uint64_t size = HeaderWord(data, 0);
  if (size > MostBytes(text, base64) || !Fetch(text, base64, word + size, data)) {
    return Fail("should hold " + std::to_string(size) + " bytes, but has fewer");
  }
  return data.substr(word);
}

// Header: number of blocks, block size, size of the last block if it is smaller (or 0), compressed sizes.
std::optional<std::string> VtuDecoder::DecodeCompressed(std::string_view text, bool base64) {
  const std::size_t word = encoding_.header_word;
  const std::uint64_t most = MostBytes(text, base64);
  std::string data;
  if (!Fetch(text, base64, word, data)) return Fail("has no header");
  const std::uint64_t blocks = HeaderWord(data, 0);
  if (blocks == 0) return std::string();
  if (blocks > most / word || !Fetch(text, base64, (3 + blocks) * word, data)) {
    return Fail("should hold " + std::to_string(blocks) + " compressed blocks, but has fewer");
  }
  const std::uint64_t block_size = HeaderWord(data, 1), last_size = HeaderWord(data, 2);
  std::vector<std::uint64_t> sizes;
  std::uint64_t compressed = 0;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    sizes.push_back(HeaderWord(data, 3 + b));
    if (sizes.back() > most - compressed) return Fail("should hold more compressed bytes than there are");
    compressed += sizes.back();
  }
  const std::size_t header = (3 + blocks) * word;
  if (!Fetch(text, base64, header + compressed, data)) return Fail("should hold more compressed bytes than there are");
  std::string inflated;
  std::size_t at = header;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::uint64_t size = b + 1 == blocks && last_size != 0 ? last_size : block_size;
    if (!Allow(size)) return Fail("is announced to be far larger than its compressed data");
    if (!Inflate(std::string_view(data).substr(at, sizes[b]), size, inflated)) {
      return Fail("cannot be decompressed (block " + std::to_string(b) + ")");
    }
    at += sizes[b];
  }
  return inflated;
}

}  // namespace fascicle
