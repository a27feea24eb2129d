#ifndef FASCICLE_CORE_IMAGING_DICOM_SERIES_H_
#define FASCICLE_CORE_IMAGING_DICOM_SERIES_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/imaging/volume_files.h"

// For this room alone.
namespace fascicle {

struct DicomFile {
  std::string name;  // for messages
  std::filesystem::path path;
};

// Stacks slices of one series, in any order, along the normal of their planes. A single file may have several slices.
// Refused, with all that is wrong: slices of several series, of different sizes or directions, two at the same place,
// gaps, and stacks that are not at right angles to their slices.
std::optional<VolumeImage> ReadDicomSeries(const std::vector<DicomFile>& files, std::int64_t memory_limit,
                                           Problems& problems);

// Whether a file says that it is DICOM.
bool IsDicom(const std::filesystem::path& path);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_DICOM_SERIES_H_
