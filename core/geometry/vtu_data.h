#ifndef FASCICLE_CORE_GEOMETRY_VTU_DATA_H_
#define FASCICLE_CORE_GEOMETRY_VTU_DATA_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace fascicle {

// Encoding of binary data in a VTK XML file: header words, then bytes, raw or in base64, optionally compressed
// ["VTK file formats", VTK User's Guide].
struct VtuEncoding {
  bool big_endian = false;
  std::size_t header_word = 4;  // bytes of a number in a header
  bool compressed = false;      // by zlib
};

// Decodes arrays of one file. Limits their total size to what such a file can reasonably hold.
class VtuDecoder {
 public:
  // `file_size` bounds the total size of all arrays.
  VtuDecoder(const VtuEncoding& encoding, std::size_t file_size);

  // The bytes of one array that starts at the beginning of `text`, in base64 or raw. Returns nothing and sets
  // `problem()` if they are incomplete.
  std::optional<std::string> Decode(std::string_view text, bool base64);
  const std::string& problem() const { return problem_; }

 private:
  // The first `size` bytes of the array's data, headers included.
  bool Fetch(std::string_view text, bool base64, std::size_t size, std::string& data);
  std::uint64_t HeaderWord(std::string_view data, std::size_t index) const;
  std::optional<std::string> DecodePlain(std::string_view text, bool base64);
  std::optional<std::string> DecodeCompressed(std::string_view text, bool base64);
  std::optional<std::string> Fail(std::string problem);
  // Deducts from the allowance; false when it is exhausted.
  bool Allow(std::uint64_t size);

  VtuEncoding encoding_;
  std::uint64_t allowance_;
  std::string problem_;
};

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_VTU_DATA_H_
