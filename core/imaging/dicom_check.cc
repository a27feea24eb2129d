#include "core/imaging/dicom_check.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <string>

namespace fascicle {
namespace {

constexpr std::uint32_t kUndefined = 0xffffffff;
constexpr std::array<std::string_view, 34> kTypes = {
    "AE", "AS", "AT", "CS", "DA", "DS", "DT", "FD", "FL", "IS", "LO", "LT", "OB", "OD", "OF", "OL", "OV",
    "OW", "PN", "SH", "SL", "SQ", "SS", "ST", "SV", "TM", "UC", "UI", "UL", "UN", "UR", "US", "UT", "UV"};
// Value representations with a length of 32 bits.
constexpr std::array<std::string_view, 13> kLongTypes = {"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                                         "SV", "UC", "UN", "UR", "UT", "UV"};

template <class List>
bool IsIn(const List& list, std::string_view what) {
  return std::find(list.begin(), list.end(), what) != list.end();
}

struct Element {
  std::uint16_t group = 0, number = 0;
  std::string_view type;  // empty: implicit
  std::uint32_t length = 0;

  bool Is(std::uint16_t g, std::uint16_t n) const { return group == g && number == n; }
};

// The values that determine how many bytes of voxels there must be.
struct ImageSize {
  std::uint32_t rows = 0, columns = 0, bits = 0, samples = 1, frames = 1;
  std::uint64_t voxel_bytes = 0;
  bool encapsulated = false, has_voxels = false;
};

class Walk {
 public:
  explicit Walk(std::string_view bytes) : bytes_(bytes) {}

  bool All(ImageSize& size) {
    constexpr std::size_t kPreamble = 128;
    if (bytes_.size() < kPreamble + 4 || bytes_.substr(kPreamble, 4) != "DICM") return false;
    at_ = kPreamble + 4;
    // The first group is always explicit and little-endian; it names the transfer syntax of the others.
    std::string syntax;
    while (at_ + 2 <= bytes_.size() && Number<std::uint16_t>(at_) == 2) {
      Element element;
      if (!TakeElement(element, bytes_.size()) || element.length > bytes_.size() - at_) return false;
      if (element.Is(2, 0x10)) syntax = std::string(Text(element.length));
      at_ += element.length;
    }
    if (syntax.empty() || syntax == "1.2.840.10008.1.2.1.99") return false;
    explicit_ = syntax != "1.2.840.10008.1.2";
    big_ = syntax == "1.2.840.10008.1.2.2";
    return Elements(bytes_.size(), false, 0, &size) && at_ == bytes_.size();
  }

 private:
  static constexpr int kDeepest = 32;

  template <class T>
  T Number(std::size_t at) const {
    T value = 0;
    for (std::size_t b = 0; b < sizeof(T); ++b) {
      const std::size_t place = big_ ? sizeof(T) - 1 - b : b;
      value = static_cast<T>(value |
                             static_cast<T>(static_cast<T>(static_cast<unsigned char>(bytes_[at + place])) << (8 * b)));
    }
    return value;
  }
  std::string_view Text(std::size_t length) const {
    std::string_view text = bytes_.substr(at_, length);
    while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.remove_suffix(1);
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    return text;
  }

  // Reads tag, type and length; the value follows.
  bool TakeElement(Element& element, std::size_t end) {
    constexpr std::size_t kShort = 8, kLong = 12;
    if (end - at_ < kShort) return false;
    element.group = Number<std::uint16_t>(at_);
    element.number = Number<std::uint16_t>(at_ + 2);
    if (!explicit_ || element.group == 0xfffe) {
      element.length = Number<std::uint32_t>(at_ + 4);
      at_ += kShort;
      return true;
    }
    element.type = bytes_.substr(at_ + 4, 2);
    if (!IsIn(kTypes, element.type)) return false;
    if (!IsIn(kLongTypes, element.type)) {
      element.length = Number<std::uint16_t>(at_ + 6);
      at_ += kShort;
      return true;
    }
    if (end - at_ < kLong) return false;
    element.length = Number<std::uint32_t>(at_ + 8);
    at_ += kLong;
    return true;
  }

  // Reads elements up to `end`, or up to the end of an item of undefined length.
  bool Elements(std::size_t end, bool until_item_ends, int depth, ImageSize* size) {
    if (depth > kDeepest) return false;
    std::uint32_t last = 0;
    while (at_ < end) {
      Element element;
      if (!TakeElement(element, end)) return false;
      if (element.Is(0xfffe, 0xe00d)) return until_item_ends && element.length == 0;
      const std::uint32_t tag = (std::uint32_t{element.group} << 16) | element.number;
      // Tags must ascend.
      if (tag <= last || element.group == 0xfffe) return false;
      last = tag;
      if (!Value(element, end, depth, size)) return false;
    }
    return !until_item_ends;
  }

  bool Value(const Element& element, std::size_t end, int depth, ImageSize* size) {
    const bool voxels = element.Is(0x7fe0, 0x10);
    if (voxels && size != nullptr) {
      size->has_voxels = true;
      size->encapsulated = element.length == kUndefined;
      size->voxel_bytes = element.length;
    }
    if (element.length == kUndefined) return voxels ? Fragments(end) : Items(end, true, depth);
    if (element.length > end - at_) return false;
    if (element.type == "SQ") return Items(at_ + element.length, false, depth);
    if (size != nullptr && !TakeSize(element, *size)) return false;
    if (!CheckText(element)) return false;
    at_ += element.length;
    return true;
  }

  // Reads the items of a sequence, up to `end` or its delimiter.
  bool Items(std::size_t end, bool until_delimiter, int depth) {
    while (at_ < end) {
      Element item;
      if (!TakeElement(item, end)) return false;
      if (item.Is(0xfffe, 0xe0dd)) return until_delimiter && item.length == 0;
      if (!item.Is(0xfffe, 0xe000)) return false;
      const bool open = item.length == kUndefined;
      if (!open && item.length > end - at_) return false;
      if (!Elements(open ? end : at_ + item.length, open, depth + 1, nullptr)) return false;
    }
    return !until_delimiter;
  }

  // Reads the fragments of compressed voxels.
  bool Fragments(std::size_t end) {
    while (at_ < end) {
      Element item;
      if (!TakeElement(item, end)) return false;
      if (item.Is(0xfffe, 0xe0dd)) return item.length == 0;
      if (!item.Is(0xfffe, 0xe000) || item.length > end - at_) return false;
      at_ += item.length;
    }
    return false;
  }

  bool TakeSize(const Element& element, ImageSize& size) {
    if (element.Is(0x28, 8)) {
      const std::string_view text = Text(element.length);
      const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), size.frames);
      return error == std::errc() && rest == text.data() + text.size();
    }
    if (element.group != 0x28) return true;
    std::uint32_t* number = element.number == 2       ? &size.samples
                            : element.number == 0x10  ? &size.rows
                            : element.number == 0x11  ? &size.columns
                            : element.number == 0x100 ? &size.bits
                                                      : nullptr;
    if (number == nullptr) return true;
    if (element.length != 2) return false;
    *number = Number<std::uint16_t>(at_);
    return true;
  }

  // Numeric text may contain only digits, signs, points, exponents and separators.
  bool CheckText(const Element& element) const {
    if (element.type != "DS" && element.type != "IS") return true;
    return bytes_.substr(at_, element.length).find_first_not_of(std::string_view("0123456789+-.eE\\ \0", 19)) ==
           std::string_view::npos;
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  bool explicit_ = true, big_ = false;
};

}  // namespace

bool CheckDicom(std::string_view bytes, Problems& problems) {
  ImageSize size;
  if (!Walk(bytes).All(size)) {
    problems.Add("", "it is not a complete DICOM file", "is it complete, and is it what its extension says?");
    return false;
  }
  if (!size.has_voxels || size.rows == 0 || size.columns == 0) {
    problems.Add("", "the DICOM file has no image", "give the files of an image series");
    return false;
  }
  const bool known_bits = size.bits == 8 || size.bits == 12 || size.bits == 16 || size.bits == 32;
  const std::uint64_t voxels = std::uint64_t{size.rows} * size.columns * size.samples * size.frames;
  if (!known_bits || (!size.encapsulated && size.voxel_bytes < voxels * size.bits / 8)) {
    problems.Add("",
                 "the DICOM file has " + std::to_string(size.voxel_bytes) + " bytes of voxels, of " +
                     std::to_string(voxels * size.bits / 8) + " that its header claims",
                 "is it complete, and is its header right?");
    return false;
  }
  return true;
}

}  // namespace fascicle
