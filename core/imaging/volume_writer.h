#ifndef FASCICLE_CORE_IMAGING_VOLUME_WRITER_H_
#define FASCICLE_CORE_IMAGING_VOLUME_WRITER_H_

#include <filesystem>

#include "core/base/problems.h"
#include "core/imaging/volume_image.h"
#include "core/imaging/volume_reader.h"

namespace fascicle {

// Writes an image, compressed, in millimetres: .mha, .nrrd, .nii or .nii.gz. For integer `type`s, values are rounded
// and clamped to the range of the type. The file is written beside and renamed, so it is complete or absent. Adds to
// `problems` (with an empty path) what went wrong.
void WriteVolume(const VolumeImage& image, VoxelType type, const std::filesystem::path& path, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_VOLUME_WRITER_H_
