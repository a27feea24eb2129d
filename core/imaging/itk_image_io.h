#ifndef FASCICLE_CORE_IMAGING_ITK_IMAGE_IO_H_
#define FASCICLE_CORE_IMAGING_ITK_IMAGE_IO_H_

#include <filesystem>
#include <optional>
#include <string>

#include "core/imaging/volume_files.h"
#include "core/imaging/volume_reader.h"

// The only access to ITK's readers and writers of files. Internal to this room.
namespace fascicle {

struct ItkFile {
  VolumeFormat format = VolumeFormat::kMetaImage;  // not kRaw
  std::filesystem::path path;
  std::uint64_t bytes = 0;  // upper bound for the size of the voxels in the file
  bool compressed = false;
  std::uint64_t bytes_per_voxel = 0;  // in the file; 0: as ITK reports it after rescaling
};

struct ItkVolume {
  VolumeImage image;
  std::string series;  // of DICOM: identifier of the slice's series
};

// Reads an image; `name` is for messages. The header is checked before anything of the image's size is allocated.
std::optional<ItkVolume> ReadByItk(const ItkFile& file, std::int64_t memory_limit, Problems& problems);

// Writes an image, compressed. False if that fails. Not kDicom, not kRaw.
bool WriteByItk(const VolumeImage& image, VoxelType type, VolumeFormat format, const std::filesystem::path& path);

// Converts `count` numbers of a file, in the machine's byte order, to floats.
void ConvertVoxels(VoxelType type, const char* bytes, std::size_t count, float* values);

std::size_t BytesOf(VoxelType type);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_ITK_IMAGE_IO_H_
