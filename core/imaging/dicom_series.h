#ifndef FASCICLE_CORE_IMAGING_DICOM_SERIES_H_
#define FASCICLE_CORE_IMAGING_DICOM_SERIES_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/imaging/volume_reader.h"

// Internal to this room.
namespace fascicle {

struct DicomFile {
  std::string name;  // for messages
  std::filesystem::path path;
};

// Stacks the slices of one series, in any order, along the normal of their planes. The frames of a file are slices,
// too: each lies where its own position says, or else at the distance that the file states. Refuses, reporting every
// problem: sizes and positions that are not stated, slices of several series, slices of different sizes or directions,
// two slices at the same position, gaps, and stacks that are not perpendicular to their slices.
std::optional<VolumeImage> ReadDicomSeries(const std::vector<DicomFile>& files, const VolumeReaderOptions& options,
                                           Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_DICOM_SERIES_H_
