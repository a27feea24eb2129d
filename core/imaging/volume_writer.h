#ifndef FASCICLE_CORE_IMAGING_VOLUME_WRITER_H_
#define FASCICLE_CORE_IMAGING_VOLUME_WRITER_H_

#include <filesystem>

#include "core/base/problems.h"
#include "core/imaging/volume_image.h"
#include "core/imaging/volume_reader.h"

namespace fascicle {

// Writes an image, compressed, with millimetres as unit: .mha, .nrrd, .nii or .nii.gz. Values are rounded and cut off
// to the range of whole `type`s. The file is whole or not there: it is written beside and renamed. Adds to `problems`
// (with an empty path) what went wrong.
void WriteVolume(const VolumeImage& image, VoxelType type, const std::filesystem::path& path, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_VOLUME_WRITER_H_
