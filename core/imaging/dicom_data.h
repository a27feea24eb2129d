#ifndef FASCICLE_CORE_IMAGING_DICOM_DATA_H_
#define FASCICLE_CORE_IMAGING_DICOM_DATA_H_

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "core/imaging/volume_reader.h"

// Internal to this room.
namespace fascicle {

struct DicomElement;
using DicomItem = std::vector<DicomElement>;  // in ascending order of tags

struct DicomElement {
  std::uint32_t tag = 0;                    // group * 65536 + number
  std::string_view type;                    // such as "DS"; empty in implicit files
  std::string_view value;                   // of all but sequences
  std::vector<DicomItem> items;             // of a sequence
  std::vector<std::string_view> fragments;  // of compressed voxels; the first is the table of offsets
};

// The elements of a DICOM file, none of which is interpreted yet.
class DicomData {
 public:
  // Parses a whole file: with or without a preamble, explicit or implicit, either byte order, deflated or not. Its
  // elements must be of known types, ascend, nest and end correctly. Otherwise returns nothing and adds a problem.
  // Throws Stopped after a stop request.
  static std::optional<DicomData> Parse(std::string_view bytes, const VolumeReaderOptions& options, Problems& problems);

  const DicomItem& elements() const { return elements_; }
  bool big_endian() const { return big_endian_; }
  const std::string& syntax() const { return syntax_; }  // identifier of the transfer syntax

  // An unsigned number of 16 bits at the top; `absent` if there is none.
  std::uint32_t Word(std::uint32_t tag, std::uint32_t absent) const;
  // Text without its padding; empty if there is none.
  std::string Text(std::uint32_t tag) const;

 private:
  std::vector<char> bytes_;  // to which the elements refer
  std::string syntax_;
  bool big_endian_ = false;
  DicomItem elements_;
};

const DicomElement* Find(const DicomItem& item, std::uint32_t tag);
// Decimal numbers separated by backslashes; nothing if one is not a number.
std::optional<std::vector<double>> Decimals(const DicomElement& element);

// Whether a file starts like a DICOM file, with or without a preamble.
bool IsDicom(const std::filesystem::path& path);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_DICOM_DATA_H_
