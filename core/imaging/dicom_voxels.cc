// [DICOM PS3.5, 8: pixel data]
#include "core/imaging/dicom_voxels.h"

#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <string>

#include "core/imaging/volume_files.h"

namespace fascicle {
namespace {

constexpr std::uint32_t kPixelData = 0x7fe00010;

// How a number is stored: `stored` of `allocated` bits, of which the uppermost is `high`.
struct Bits {
  std::uint32_t allocated = 16, stored = 16, high = 15;
  bool is_signed = false;
};

std::optional<Bits> BitsOf(const DicomData& data, Problems& problems) {
  Bits bits;
  bits.allocated = data.Word(0x00280100, 0);
  bits.stored = data.Word(0x00280101, bits.allocated);
  bits.high = data.Word(0x00280102, bits.stored - 1);
  bits.is_signed = data.Word(0x00280103, 0) == 1;
  const bool known = bits.allocated == 1 || bits.allocated == 8 || bits.allocated == 16 || bits.allocated == 32;
  if (known && bits.stored >= 1 && bits.stored <= bits.allocated && bits.high < bits.allocated &&
      bits.high + 1 >= bits.stored) {
    return bits;
  }
  problems.Add("",
               "the DICOM file stores numbers in " + std::to_string(bits.allocated) + " bits, of which " +
                   std::to_string(bits.stored) + " count, up to bit " + std::to_string(bits.high),
               "1, 8, 16 or 32 bits can be read");
  return std::nullopt;
}

bool CheckColours(const DicomData& data, Problems& problems) {
  const std::uint32_t samples = data.Word(0x00280002, 1);
  if (samples != 1) {
    problems.Add("", "the image has " + std::to_string(samples) + " components a voxel",
                 "only one can be read: save one channel by itself");
    return false;
  }
  if (data.Text(0x00280004) != "PALETTE COLOR") return true;
  problems.Add("", "the image has colours of a palette", "it is a picture, not a scan: save the original");
  return false;
}

// The bytes of all frames from compressed fragments, in the machine's order; empty if that fails.
std::vector<char> DecodeFragments(const DicomData& data, const DicomElement& voxels, const DicomVoxels& size,
                                  const Bits& bits) {
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
  std::vector<char> bytes;
  if (voxels.fragments.empty()) return bytes;
  try {
    gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = gdcm::SequenceOfFragments::New();
    const auto length = [](std::string_view text) { return static_cast<std::uint32_t>(text.size()); };
    gdcm::BasicOffsetTable table;
    table.SetByteValue(voxels.fragments[0].data(), length(voxels.fragments[0]));
    fragments->GetTable() = table;
    for (std::size_t f = 1; f < voxels.fragments.size(); ++f) {
      gdcm::Fragment fragment;
      fragment.SetByteValue(voxels.fragments[f].data(), length(voxels.fragments[f]));
      fragments->AddFragment(fragment);
    }
    gdcm::DataElement element(gdcm::Tag(0x7fe0, 0x0010));
    element.SetVR(gdcm::VR::OB);
    element.SetValue(*fragments);
    gdcm::Image image;
    image.SetNumberOfDimensions(size.frames > 1 ? 3 : 2);
    image.SetDimension(0, size.columns);
    image.SetDimension(1, size.rows);
    if (size.frames > 1) image.SetDimension(2, size.frames);
    const auto word = [](std::uint32_t value) { return static_cast<unsigned short>(value); };
    image.SetPixelFormat(
        gdcm::PixelFormat(1, word(bits.allocated), word(bits.stored), word(bits.high), bits.is_signed ? 1 : 0));
    image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
    image.SetTransferSyntax(gdcm::TransferSyntax::GetTSType(data.syntax().c_str()));
    image.SetDataElement(element);
    bytes.resize(image.GetBufferLength());
    if (!image.GetBuffer(bytes.data())) bytes.clear();
  } catch (const std::exception&) {
    bytes.clear();
  }
  return bytes;
}

// One bit per voxel, the lowest of a byte first.
void Unbit(std::string_view bytes, std::vector<float>& values) {
  for (std::size_t v = 0; v < values.size(); ++v) {
    values[v] = static_cast<float>(static_cast<unsigned char>(bytes[v / 8]) >> (v % 8) & 1);
  }
}

void ConvertBits(std::string_view bytes, const Bits& bits, bool big_endian, bool in_words, std::vector<float>& values) {
  const std::size_t width = bits.allocated / 8;
  const std::uint64_t mask = (std::uint64_t{1} << bits.stored) - 1, sign = std::uint64_t{1} << (bits.stored - 1);
  // Big-endian words hold two numbers of a byte in the opposite order.
  const bool swapped_pairs = big_endian && in_words && width == 1;
  for (std::size_t v = 0; v < values.size(); ++v) {
    std::uint64_t number = 0;
    for (std::size_t b = 0; b < width; ++b) {
      std::size_t at = v * width + (big_endian ? width - 1 - b : b);
      if (swapped_pairs && (at ^ 1) < bytes.size()) at ^= 1;
      number |= std::uint64_t{static_cast<unsigned char>(bytes[at])} << (8 * b);
    }
    number = number >> (bits.high + 1 - bits.stored) & mask;
    const auto whole = static_cast<std::int64_t>(number);
    values[v] = static_cast<float>(bits.is_signed && (number & sign) != 0 ? whole - static_cast<std::int64_t>(mask) - 1
                                                                          : whole);
  }
}

}  // namespace

std::optional<DicomVoxels> ReadDicomVoxels(const DicomData& data, std::int64_t memory_limit, Problems& problems) {
  const DicomElement* voxels = Find(data.elements(), kPixelData);
  DicomVoxels read;
  read.rows = data.Word(0x00280010, 0);
  read.columns = data.Word(0x00280011, 0);
  if (const DicomElement* frames = Find(data.elements(), 0x00280008)) {
    const auto count = Decimals(*frames);
    const bool ok = count && count->size() == 1 && (*count)[0] >= 1 && (*count)[0] < 1e9;
    read.frames = ok ? static_cast<std::uint32_t>((*count)[0]) : 0;
  }
  const bool has_voxels = voxels != nullptr && (!voxels->value.empty() || !voxels->fragments.empty());
  if (!has_voxels || read.rows == 0 || read.columns == 0 || read.frames == 0) {
    problems.Add("", "the DICOM file has no image", "give the files of an image series");
    return std::nullopt;
  }
  const std::optional<Bits> bits = BitsOf(data, problems);
  if (!CheckColours(data, problems) || !bits) return std::nullopt;
  const bool compressed = !voxels->fragments.empty();
  std::uint64_t available = voxels->value.size();
  for (const std::string_view fragment : voxels->fragments) available += fragment.size();
  const std::uint64_t count = std::uint64_t{read.columns} * read.rows * read.frames;
  const std::uint64_t need = (count * bits->allocated + 7) / 8;
  if (!compressed && available < need) {
    problems.Add("",
                 "the DICOM file has " + std::to_string(available) + " bytes of voxels, of " + std::to_string(need) +
                     " that its header claims",
                 "is it complete, and is its header right?");
    return std::nullopt;
  }
  // Coders of pictures compress an even one further than deflate does.
  constexpr std::uint64_t kPictures = 64;
  const VolumeClaim claim{{read.columns, read.rows, read.frames},
                          std::max(bits->allocated / 8, 1U),
                          compressed ? available * kPictures : std::max(available, count),
                          compressed};
  if (!CheckClaim(claim, memory_limit, problems)) return std::nullopt;
  std::vector<char> decoded;
  std::string_view bytes = voxels->value;
  if (compressed) {
    decoded = DecodeFragments(data, *voxels, read, *bits);
    bytes = {decoded.data(), decoded.size()};
  }
  if (bytes.size() < need) {
    problems.Add("", "the file's compressed voxels (transfer syntax " + data.syntax() + ") can't be decoded",
                 "is it complete?");
    return std::nullopt;
  }
  read.values.resize(count);
  if (bits->allocated == 1) {
    Unbit(bytes, read.values);
  } else {
    ConvertBits(bytes, *bits, data.big_endian() && !compressed, voxels->type == "OW", read.values);
  }
  return read;
}

}  // namespace fascicle
