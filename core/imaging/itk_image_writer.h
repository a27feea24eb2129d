#ifndef FASCICLE_CORE_IMAGING_ITK_IMAGE_WRITER_H_
#define FASCICLE_CORE_IMAGING_ITK_IMAGE_WRITER_H_

#include <filesystem>

#include "core/imaging/volume_files.h"
#include "core/imaging/volume_reader.h"

// The only access to ITK's writers of files. Internal to this room.
namespace fascicle {

// Writes an image, compressed. False if that fails. Not kDicom, not kRaw.
bool WriteByItk(const VolumeImage& image, VoxelType type, VolumeFormat format, const std::filesystem::path& path);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_ITK_IMAGE_WRITER_H_
