#ifndef FASCICLE_CORE_IMAGING_ITK_IMAGE_IO_H_
#define FASCICLE_CORE_IMAGING_ITK_IMAGE_IO_H_

#include <filesystem>
#include <optional>
#include <string>

#include "core/imaging/volume_files.h"
#include "core/imaging/volume_reader.h"

// The one door to ITK's readers and writers of files. For this room alone.
namespace fascicle {

struct ItkFile {
  VolumeFormat format = VolumeFormat::kMetaImage;  // not kRaw
  std::filesystem::path path;
  std::uint64_t bytes = 0;  // that the voxels can have in the file
  bool compressed = false;
  std::uint64_t bytes_per_voxel = 0;  // in the file; 0: as ITK says, which is after rescaling
};

struct ItkVolume {
  VolumeImage image;
  std::string series;  // of DICOM: which the slice belongs to
};

// Reads an image with `name` for messages; its header is checked before anything as large as the image is made.
std::optional<ItkVolume> ReadByItk(const ItkFile& file, std::int64_t memory_limit, Problems& problems);

// Writes an image, compressed. False when it can't be written. Not kDicom, not kRaw.
bool WriteByItk(const VolumeImage& image, VoxelType type, VolumeFormat format, const std::filesystem::path& path);

// Numbers of a file as floats: count of them, in the machine's byte order.
void ConvertVoxels(VoxelType type, const char* bytes, std::size_t count, float* values);

std::size_t BytesOf(VoxelType type);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_ITK_IMAGE_IO_H_
