#ifndef FASCICLE_CORE_IMAGING_VOLUME_READER_H_
#define FASCICLE_CORE_IMAGING_VOLUME_READER_H_

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/problems.h"
#include "core/imaging/volume_image.h"

namespace fascicle {

enum class VoxelType { kUint8, kInt8, kUint16, kInt16, kUint32, kInt32, kFloat32, kFloat64, kInt64, kUint64 };

// "uint8" ... "uint64".
std::string NameOf(VoxelType type);
std::optional<VoxelType> VoxelTypeOf(std::string_view name);

// What a file of bare numbers (.raw) does not say itself.
struct RawLayout {
  GridIndex size = {0, 0, 0};
  Vec3 spacing = Vec3::Constant(1e-3);  // [m]
  VoxelType type = VoxelType::kInt16;
  bool big_endian = false;
  std::int64_t header_bytes = 0;  // bytes before the numbers, which are skipped
};

struct VolumeReaderOptions {
  std::optional<RawLayout> raw;  // required for .raw, and only allowed there
  // Most memory that reading may need [byte]: 4 bytes per voxel plus the file's own size. Larger images are refused by
  // their header.
  std::int64_t memory_limit = std::int64_t{8} << 30;
  std::stop_token stop;  // reading throws Stopped once it is requested
};

// The bytes of a file. The views must stay valid during the call only.
struct VolumeFile {
  std::string_view name;  // its extension gives the format; leading folders are ignored
  std::string_view bytes;
};

// Reads one image from its file or files:
//   .mha .nrrd .nii .nii.gz    one file; NIfTI-1 and NIfTI-2, whether it is packed or not
//   .mhd .nhdr .hdr            a header, and the data files that it names (beside it)
//   .dcm                       slices of a series in any order, of one or several frames; files of a series may lack
//   the extension
//   .raw                       bare numbers, with options.raw
// Lengths are converted to metres: files are in millimetres, unless they say otherwise (NIfTI, NRRD, MetaImage).
// Positions are in DICOM's patient coordinates; those of files in other coordinates are converted. Compressed data,
// both byte orders and all number types are supported, with the rescaling given by the file (slope and intercept). The
// image's notes say what was decided where a file leaves something open or says it twice. Malformed input never
// crashes, hangs or allocates more than a small multiple of what the files can hold. It adds to `problems` (with empty
// paths) and returns nothing. So do images with several components per voxel or in time, with non-finite numbers
// (which NIfTI allows: they are read as 0), without voxels, or with more than 2^31 - 1 voxels. Thread-safe, except for
// calls with the same files.
std::optional<VolumeImage> ReadVolume(const std::vector<VolumeFile>& files, const VolumeReaderOptions& options,
                                      Problems& problems);
// The same for files on disk. A folder stands for the DICOM files in it and in its folders, and a header also for the
// files that it names.
std::optional<VolumeImage> ReadVolumeFiles(const std::vector<std::filesystem::path>& paths,
                                           const VolumeReaderOptions& options, Problems& problems);

// Whether a file's extension is one of those above.
bool IsVolumeName(std::string_view name);
// For messages: ".mha, .mhd, ...".
std::string KnownVolumeExtensions();

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_VOLUME_READER_H_
