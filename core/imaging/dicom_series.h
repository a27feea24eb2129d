#ifndef FASCICLE_CORE_IMAGING_DICOM_SERIES_H_
#define FASCICLE_CORE_IMAGING_DICOM_SERIES_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/imaging/volume_files.h"
#include "core/imaging/volume_reader.h"

// Internal to this room.
namespace fascicle {

struct DicomFile {
  std::string name;  // for messages
  std::filesystem::path path;
};

// Stacks the slices of one series, in any order, along the normal of their planes. A single file may contain several
// slices. Refuses, reporting every problem: slices of several series, slices of different sizes or directions, two
// slices at the same position, gaps, and stacks that are not perpendicular to their slices.
std::optional<VolumeImage> ReadDicomSeries(const std::vector<DicomFile>& files, const VolumeReaderOptions& options,
                                           Problems& problems);

// Whether a file starts like a DICOM file.
bool IsDicom(const std::filesystem::path& path);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_DICOM_SERIES_H_
