#ifndef FASCICLE_TESTS_SUPPORT_VOLUME_FILES_H_
#define FASCICLE_TESTS_SUPPORT_VOLUME_FILES_H_

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "core/geometry/voxel_grid.h"

// Handmade image files, byte by byte.
namespace fascicle::testing {

// The bytes of a number, most significant first or last.
template <class T>
std::string Number(T value, bool big_endian = false) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (big_endian != (std::endian::native == std::endian::big)) bytes.assign(bytes.rbegin(), bytes.rend());
  return bytes;
}

// A handmade NIfTI-1 file of shorts: an sform of `spacing` [mm] along the axes, and values slope * number + intercept.
inline std::string NiftiBytes(const GridIndex& size, const std::string& voxels, bool big_endian, float slope = 0,
                              float intercept = 0) {
  std::string header(352, '\0');
  const auto put = [&](std::size_t at, const std::string& bytes) { header.replace(at, bytes.size(), bytes); };
  const auto word = [&](std::int16_t value) { return Number<std::int16_t>(value, big_endian); };
  const auto real = [&](float value) { return Number<float>(value, big_endian); };
  put(0, Number<std::int32_t>(348, big_endian));
  put(40, word(3) + word(static_cast<std::int16_t>(size[0])) + word(static_cast<std::int16_t>(size[1])) +
              word(static_cast<std::int16_t>(size[2])) + word(1) + word(1) + word(1) + word(1));
  put(70, word(4) + word(16));  // signed short
  put(76, real(1) + real(2) + real(3) + real(4));
  put(108, real(352) + real(slope) + real(intercept));
  header[123] = 2;    // mm
  put(254, word(1));  // sform: scanner
  put(280, real(2) + real(0) + real(0) + real(10) + real(0) + real(3) + real(0) + real(20) + real(0) + real(0) +
               real(4) + real(30));
  put(344, std::string("n+1", 4));
  return header + voxels;
}

// The fields of a slice of a DICOM series [mm].
struct DicomSlice {
  int rows = 3, columns = 4;
  std::string series = "1.2.3.4";
  std::string position = "-10\\20\\5";
  std::string orientation = "1\\0\\0\\0\\1\\0";
  std::string spacing = "1.5\\0.75";  // between rows, between columns
  std::string slope = "1", intercept = "0";
  std::string thickness = "2.5";
  int first_value = 0;      // of the first voxel; the others increase by one
  std::vector<int> voxels;  // or all of them, as stored
};

// A file of that slice in DICOM's explicit little-endian syntax.
inline std::string DicomBytes(const DicomSlice& slice) {
  const auto element = [](int group, int number, const std::string& type, std::string value) {
    if (value.size() % 2 == 1) value += type == "UI" ? '\0' : ' ';
    std::string bytes = Number<std::uint16_t>(static_cast<std::uint16_t>(group)) +
                        Number<std::uint16_t>(static_cast<std::uint16_t>(number)) + type;
    if (type == "OW" || type == "OB") {
      bytes += std::string(2, '\0') + Number<std::uint32_t>(static_cast<std::uint32_t>(value.size()));
    } else {
      bytes += Number<std::uint16_t>(static_cast<std::uint16_t>(value.size()));
    }
    return bytes + value;
  };
  const auto word = [](int value) { return Number<std::uint16_t>(static_cast<std::uint16_t>(value)); };
  const std::string mr = "1.2.840.10008.5.1.4.1.1.4",
                    instance = slice.series + "." + std::to_string(slice.first_value + 1);
  const std::string meta = element(2, 1, "OB", std::string("\0\1", 2)) + element(2, 2, "UI", mr) +
                           element(2, 3, "UI", instance) + element(2, 0x10, "UI", "1.2.840.10008.1.2.1");
  std::string pixels;
  for (int v = 0; v < slice.rows * slice.columns; ++v) {
    pixels += word(slice.voxels.empty() ? slice.first_value + v : slice.voxels[static_cast<std::size_t>(v)]);
  }
  return std::string(128, '\0') + "DICM" +
         element(2, 0, "UL", Number<std::uint32_t>(static_cast<std::uint32_t>(meta.size()))) + meta +
         element(8, 0x16, "UI", mr) + element(8, 0x18, "UI", instance) + element(8, 0x60, "CS", "MR") +
         (slice.thickness.empty() ? "" : element(0x18, 0x50, "DS", slice.thickness)) +
         element(0x20, 0xd, "UI", "1.2.3") + element(0x20, 0xe, "UI", slice.series) +
         element(0x20, 0x32, "DS", slice.position) + element(0x20, 0x37, "DS", slice.orientation) +
         element(0x28, 2, "US", word(1)) + element(0x28, 4, "CS", "MONOCHROME2") +
         element(0x28, 0x10, "US", word(slice.rows)) + element(0x28, 0x11, "US", word(slice.columns)) +
         element(0x28, 0x30, "DS", slice.spacing) + element(0x28, 0x100, "US", word(16)) +
         element(0x28, 0x101, "US", word(16)) + element(0x28, 0x102, "US", word(15)) +
         element(0x28, 0x103, "US", word(0)) + element(0x28, 0x1052, "DS", slice.intercept) +
         element(0x28, 0x1053, "DS", slice.slope) + element(0x7fe0, 0x10, "OW", pixels);
}

}  // namespace fascicle::testing

#endif  // FASCICLE_TESTS_SUPPORT_VOLUME_FILES_H_
