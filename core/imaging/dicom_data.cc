// [DICOM PS3.5, 7: the data set; PS3.10, 7: the file]
#include "core/imaging/dicom_data.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>

#include "core/imaging/unpack.h"

namespace fascicle {
namespace {

constexpr std::uint32_t kUndefined = 0xffffffff, kVoxels = 0x7fe00010;
constexpr std::uint32_t kItem = 0xfffee000, kItemEnd = 0xfffee00d, kSequenceEnd = 0xfffee0dd;
constexpr std::size_t kPreamble = 128;
constexpr std::array<std::string_view, 34> kElementTypes = {
    "AE", "AS", "AT", "CS", "DA", "DS", "DT", "FD", "FL", "IS", "LO", "LT", "OB", "OD", "OF", "OL", "OV",
    "OW", "PN", "SH", "SL", "SQ", "SS", "ST", "SV", "TM", "UC", "UI", "UL", "UN", "UR", "US", "UT", "UV"};
// Value representations with a length of 32 bits.
constexpr std::array<std::string_view, 13> kLongTypes = {"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                                         "SV", "UC", "UN", "UR", "UT", "UV"};
// Sequences that are read where a file does not say which elements are sequences: functional groups of frames, with
// their positions, orientations, measures and rescaling.
constexpr std::array<std::uint32_t, 6> kSequences = {0x52009229, 0x52009230, 0x00209113,
                                                     0x00209116, 0x00289110, 0x00289145};

template <class List, class T>
bool IsIn(const List& list, const T& what) {
  return std::find(list.begin(), list.end(), what) != list.end();
}

std::string_view WithoutPadding(std::string_view text) {
  while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.remove_suffix(1);
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  return text;
}

// Reads elements one after the other. All functions return false where the bytes are no such elements.
class ElementWalk {
 public:
  ElementWalk(std::string_view bytes, bool has_types, bool big_endian)
      : bytes_(bytes), has_types_(has_types), big_(big_endian) {}

  bool AtEnd() const { return at_ == bytes_.size(); }
  std::size_t at() const { return at_; }

  // Reads elements up to `end`, or up to the end of an item of undefined length.
  bool Elements(std::size_t end, bool until_item_ends, int depth, DicomItem& item) {
    constexpr int kDeepest = 32;
    if (depth > kDeepest) return false;
    while (at_ < end) {
      DicomElement element;
      std::uint32_t length = 0;
      if (!TakeStart(end, element, length)) return false;
      if (element.tag == kItemEnd) return until_item_ends && length == 0;
      const bool ascends = item.empty() ? element.tag > 0 : element.tag > item.back().tag;
      if (!ascends || element.tag >> 16 == 0xfffe || !TakeValue(end, length, depth, element)) return false;
      item.push_back(std::move(element));
    }
    return !until_item_ends;
  }

  // Reads the elements of group 2 at the start, which are always explicit and little-endian.
  bool Meta(DicomItem& item) {
    while (at_ + 2 <= bytes_.size() && Number<std::uint16_t>(at_) == 2) {
      DicomElement element;
      std::uint32_t length = 0;
      if (!TakeStart(bytes_.size(), element, length) || length > bytes_.size() - at_) return false;
      element.value = bytes_.substr(at_, length);
      at_ += length;
      item.push_back(std::move(element));
    }
    return true;
  }

 private:
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

  // Reads tag, type and length; the value follows.
  bool TakeStart(std::size_t end, DicomElement& element, std::uint32_t& length) {
    constexpr std::size_t kShort = 8, kLong = 12;
    if (end - at_ < kShort) return false;
    const auto group = Number<std::uint16_t>(at_);
    element.tag = (std::uint32_t{group} << 16) | Number<std::uint16_t>(at_ + 2);
    if (!has_types_ || group == 0xfffe) {
      length = Number<std::uint32_t>(at_ + 4);
      at_ += kShort;
      return true;
    }
    element.type = bytes_.substr(at_ + 4, 2);
    if (!IsIn(kElementTypes, element.type)) return false;
    if (!IsIn(kLongTypes, element.type)) {
      length = Number<std::uint16_t>(at_ + 6);
      at_ += kShort;
      return true;
    }
    if (end - at_ < kLong) return false;
    length = Number<std::uint32_t>(at_ + 8);
    at_ += kLong;
    return true;
  }

  bool TakeValue(std::size_t end, std::uint32_t length, int depth, DicomElement& element) {
    if (length == kUndefined) {
      return element.tag == kVoxels ? Fragments(end, element) : Items(end, true, depth, element);
    }
    if (length > end - at_) return false;
    const bool is_sequence = has_types_ ? element.type == "SQ" : IsIn(kSequences, element.tag);
    if (is_sequence) return Items(at_ + length, false, depth, element);
    element.value = bytes_.substr(at_, length);
    at_ += length;
    return true;
  }

  // Reads the items of a sequence, up to `end` or its delimiter.
  bool Items(std::size_t end, bool until_delimiter, int depth, DicomElement& sequence) {
    while (at_ < end) {
      DicomElement start;
      std::uint32_t length = 0;
      if (!TakeStart(end, start, length)) return false;
      if (start.tag == kSequenceEnd) return until_delimiter && length == 0;
      if (start.tag != kItem) return false;
      const bool open = length == kUndefined;
      if (!open && length > end - at_) return false;
      sequence.items.emplace_back();
      if (!Elements(open ? end : at_ + length, open, depth + 1, sequence.items.back())) return false;
    }
    return !until_delimiter;
  }

  // Reads the fragments of compressed voxels.
  bool Fragments(std::size_t end, DicomElement& voxels) {
    while (at_ < end) {
      DicomElement start;
      std::uint32_t length = 0;
      if (!TakeStart(end, start, length)) return false;
      if (start.tag == kSequenceEnd) return length == 0;
      if (start.tag != kItem || length > end - at_) return false;
      voxels.fragments.push_back(bytes_.substr(at_, length));
      at_ += length;
    }
    return false;
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  bool has_types_, big_;
};

bool HasPreamble(std::string_view bytes) {
  return bytes.size() >= kPreamble + 4 && bytes.substr(kPreamble, 4) == "DICM";
}

bool HasType(std::string_view element) { return IsIn(kElementTypes, element.substr(4, 2)); }

// Old files start with the data set itself: a short element of group 2 or 8.
bool LooksLikeElement(std::string_view bytes) {
  if (bytes.size() < 8) return false;
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(bytes[at]); };
  const bool known_group = (byte(0) == 2 || byte(0) == 8) && byte(1) == 0 && byte(3) == 0;
  return known_group && (HasType(bytes) || (byte(5) == 0 && byte(6) == 0 && byte(7) == 0));
}

}  // namespace

std::optional<DicomData> DicomData::Parse(std::string_view bytes, const VolumeReaderOptions& options,
                                          Problems& problems) {
  const auto refuse = [&problems] {
    problems.Add("", "it is not a complete DICOM file", "is it complete, and is it what its extension says?");
    return std::nullopt;
  };
  if (HasPreamble(bytes)) {
    bytes.remove_prefix(kPreamble + 4);
  } else if (!LooksLikeElement(bytes)) {
    return refuse();
  }
  DicomItem meta;
  ElementWalk start(bytes, true, false);
  if (!start.Meta(meta)) return refuse();
  DicomData data;
  if (const DicomElement* syntax = fascicle::Find(meta, 0x00020010)) data.syntax_ = WithoutPadding(syntax->value);
  std::string_view rest = bytes.substr(start.at());
  bool has_types = data.syntax_ != "1.2.840.10008.1.2";
  if (data.syntax_.empty()) {
    if (rest.size() < 8) return refuse();
    has_types = HasType(rest);
    data.syntax_ = has_types ? "1.2.840.10008.1.2.1" : "1.2.840.10008.1.2";
  }
  data.big_endian_ = data.syntax_ == "1.2.840.10008.1.2.2";
  std::string inflated;
  if (data.syntax_ == "1.2.840.10008.1.2.1.99") {
    const auto most = static_cast<std::uint64_t>(std::max<std::int64_t>(options.memory_limit, 0));
    if (!Unpack(Compression::kDeflateOnly, rest, most, inflated, options.stop, problems)) return std::nullopt;
    rest = inflated;
  }
  data.bytes_.assign(rest.begin(), rest.end());
  const std::string_view held(data.bytes_.data(), data.bytes_.size());
  ElementWalk walk(held, has_types, data.big_endian_);
  if (!walk.Elements(held.size(), false, 0, data.elements_) || !walk.AtEnd()) return refuse();
  return data;
}

std::uint32_t DicomData::Word(std::uint32_t tag, std::uint32_t absent) const {
  const DicomElement* element = fascicle::Find(elements_, tag);
  if (element == nullptr || element->value.size() != 2) return absent;
  const auto byte = [&](std::size_t at) -> std::uint32_t { return static_cast<unsigned char>(element->value[at]); };
  return big_endian_ ? byte(0) << 8 | byte(1) : byte(1) << 8 | byte(0);
}

std::string DicomData::Text(std::uint32_t tag) const {
  const DicomElement* element = fascicle::Find(elements_, tag);
  return element == nullptr ? std::string() : std::string(WithoutPadding(element->value));
}

const DicomElement* Find(const DicomItem& item, std::uint32_t tag) {
  const auto found = std::lower_bound(item.begin(), item.end(), tag,
                                      [](const DicomElement& element, std::uint32_t t) { return element.tag < t; });
  return found != item.end() && found->tag == tag ? &*found : nullptr;
}

std::optional<std::vector<double>> Decimals(const DicomElement& element) {
  std::vector<double> numbers;
  std::string_view rest = element.value;
  for (bool more = true; more;) {
    const std::size_t end = rest.find('\\');
    more = end != std::string_view::npos;
    std::string_view text = WithoutPadding(rest.substr(0, end));
    if (more) rest.remove_prefix(end + 1);
    if (text.starts_with('+')) text.remove_prefix(1);
    double number = 0;
    const auto [next, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || next != text.data() + text.size()) return std::nullopt;
    numbers.push_back(number);
  }
  return numbers;
}

bool IsDicom(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  char start[kPreamble + 4] = {};
  in.read(start, sizeof(start));
  const std::string_view bytes(start, static_cast<std::size_t>(in.gcount()));
  return HasPreamble(bytes) || LooksLikeElement(bytes);
}

}  // namespace fascicle
