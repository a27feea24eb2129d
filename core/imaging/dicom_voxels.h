#ifndef FASCICLE_CORE_IMAGING_DICOM_VOXELS_H_
#define FASCICLE_CORE_IMAGING_DICOM_VOXELS_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/problems.h"
#include "core/imaging/dicom_data.h"

// Internal to this room.
namespace fascicle {

struct DicomVoxels {
  std::uint32_t columns = 0, rows = 0, frames = 1;
  std::vector<float> values;  // as stored, before any rescaling; columns fastest, then rows
};

// The stored numbers of a file's frames. They are not inverted for MONOCHROME1, which is about their display.
// Compressed ones are decoded by GDCM. Returns nothing and adds to `problems` if the file has no image with one number
// per voxel, fewer bytes than its header claims, or takes more than `memory_limit` bytes.
std::optional<DicomVoxels> ReadDicomVoxels(const DicomData& data, std::int64_t memory_limit, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_DICOM_VOXELS_H_
