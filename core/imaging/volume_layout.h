#ifndef FASCICLE_CORE_IMAGING_VOLUME_LAYOUT_H_
#define FASCICLE_CORE_IMAGING_VOLUME_LAYOUT_H_

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "core/imaging/volume_image.h"
#include "core/imaging/volume_reader.h"

// What headers say. Internal to this room.
namespace fascicle {

enum class Packing {
  kNone,
  kDeflate,  // zlib or gzip
  kBzip2,
  kAsMarked,  // gzip if the file starts like it, otherwise none
};
enum class Coding { kBinary, kDecimal, kHexadecimal };

// The place of an image and how its voxels are stored: what a header of any format but DICOM comes down to.
struct VolumeLayout {
  std::array<std::uint64_t, 3> size = {0, 0, 0};
  VolumeImage image;  // its place and notes; the other members are set by ReadVoxels
  VoxelType type = VoxelType::kInt16;
  bool big_endian = false;
  double slope = 1, intercept = 0;   // value = slope * number + intercept
  bool replaces_non_finite = false;  // by 0, with a note; otherwise such numbers are refused
  Packing packing = Packing::kNone;
  Coding coding = Coding::kBinary;
  // Names of the files beside the header that hold equal parts of the voxels in this order; empty: the header's own.
  std::vector<std::string> files;
  std::int64_t start = 0;  // bytes before the (packed) voxels in each file
  std::int64_t skip = 0;   // further bytes before them once they are unpacked; negative: they are at the file's end
};

// Headers have at most this length [byte].
inline constexpr std::size_t kLongestHeader = std::size_t{4} << 20;

// The layout of an image from the start of its file, of kLongestHeader bytes at most. Lengths are in metres and places
// in DICOM's patient coordinates. Returns nothing and adds to `problems` if the bytes are no header of the format, or
// if they describe what is no volume with one number per voxel. What a header leaves open, or says twice, is noted.
std::optional<VolumeLayout> ReadMetaHeader(std::string_view bytes, Problems& problems);
std::optional<VolumeLayout> ReadNrrdHeader(std::string_view bytes, Problems& problems);
// NIfTI-1 and NIfTI-2. `pair` names the file of voxels of a pair; empty for a single file.
std::optional<VolumeLayout> ReadNiftiHeader(std::string_view bytes, std::string_view pair, Problems& problems);

// Reads the voxels of a layout, whose header is in `header`, up to the last one, and checks the place. Returns nothing
// and adds to `problems` if that fails. Throws Stopped after a stop request.
std::optional<VolumeImage> ReadVoxels(VolumeLayout layout, const std::filesystem::path& header,
                                      const VolumeReaderOptions& options, Problems& problems);

std::size_t BytesOf(VoxelType type);
// Converts `count` numbers in the machine's byte order to slope * number + intercept.
void ConvertVoxels(VoxelType type, const char* bytes, std::size_t count, double slope, double intercept, float* values);

// Parts of header readers.

// `sizes` of all axes: three, of which fewer may be given, and further ones of length 1.
bool TakeSizes(const std::vector<std::uint64_t>& sizes, VolumeLayout& layout, Problems& problems);
// Axes along i, j, k as columns, whose lengths are the spacing.
void TakeAxes(const Mat3& axes, VolumeLayout& layout);
// The names of data files: one file, "LIST" with a name on each line of `rest`, or a pattern "name%03d.raw 1 20 1".
bool TakeDataFiles(std::string_view value, std::string_view rest, VolumeLayout& layout, Problems& problems);

std::string_view Trimmed(std::string_view text);
// Removes and returns the next line of `text`, without its end; nothing at the end of the text.
std::optional<std::string_view> TakeLine(std::string_view& text);
// Numbers separated by blanks; nothing if one is not a number.
std::optional<std::vector<double>> ParseNumbers(std::string_view text);
std::optional<std::vector<std::uint64_t>> ParseCounts(std::string_view text);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_VOLUME_LAYOUT_H_
