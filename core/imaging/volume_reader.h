#ifndef FASCICLE_CORE_IMAGING_VOLUME_READER_H_
#define FASCICLE_CORE_IMAGING_VOLUME_READER_H_

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "core/imaging/volume_image.h"

namespace fascicle {

enum class VoxelType { kUint8, kInt8, kUint16, kInt16, kUint32, kInt32, kFloat32, kFloat64 };

// "uint8" ... "float64".
std::string NameOf(VoxelType type);
std::optional<VoxelType> VoxelTypeOf(std::string_view name);

// What a file of nothing but numbers (.raw) does not say itself.
struct RawLayout {
  GridIndex size = {0, 0, 0};
  Vec3 spacing = Vec3::Constant(1e-3);  // [m]
  VoxelType type = VoxelType::kInt16;
  bool big_endian = false;
  std::int64_t header_bytes = 0;  // that come before the numbers, and are left out
};

struct VolumeReaderOptions {
  std::optional<RawLayout> raw;  // required for .raw, and for these alone
  // Of what reading needs at most [byte]: 4 a voxel and the file's own. Larger images are refused by their header.
  std::int64_t memory_limit = std::int64_t{8} << 30;
};

// The bytes of a file. The views must outlive the call only.
struct VolumeFile {
  std::string_view name;  // its extension tells the format; folders before it are left out
  std::string_view bytes;
};

// Reads one image from its file or files:
//   .mha .nrrd .nii .nii.gz    one file
//   .mhd .nhdr                 a header, and the file of numbers that it names (beside it)
//   .dcm                       one slice or the slices of a series in any order; a series alone may come without
//   extension .raw                       numbers, with options.raw
// Lengths become metres: files mean millimetres, unless NIfTI says otherwise. Places are in the patient's frame of
// DICOM; NIfTI and NRRD files in others are turned. Compressed data, either byte order and all types of numbers are
// read, and rescaled as the file says (slope and intercept). Malformed input never crashes, hangs or allocates more
// than a small multiple of what the files can hold: it adds to `problems` (with empty paths) and gives nothing. So do
// images of several components a voxel or in time, of numbers that are not finite, without voxels, or with more than
// 2^31 - 1 of them. Not from two threads at once with the same files; otherwise thread-safe.
std::optional<VolumeImage> ReadVolume(const std::vector<VolumeFile>& files, const VolumeReaderOptions& options,
                                      Problems& problems);
// The same, from the disk. A folder stands for the DICOM files in it, and a header for what it names, too.
std::optional<VolumeImage> ReadVolumeFiles(const std::vector<std::filesystem::path>& paths,
                                           const VolumeReaderOptions& options, Problems& problems);

// The file beside it that a header (.mhd, .nhdr) names; empty when it has the numbers itself or is no header. Adds to
// `problems` where it names several files, or one in another folder.
std::string DataFileOf(const VolumeFile& header, Problems& problems);

// Whether a file's extension is one of those above.
bool IsVolumeName(std::string_view name);
// For messages: ".mha, .mhd, ...".
std::string KnownVolumeExtensions();

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_VOLUME_READER_H_
