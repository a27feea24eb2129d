#ifndef FASCICLE_CLIENT_IMAGE_LABEL_SURFACE_H_
#define FASCICLE_CLIENT_IMAGE_LABEL_SURFACE_H_

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/triangle_mesh.h"

namespace fascicle::client {

// A label of an image as a closed surface [mm], in DICOM's patient coordinates.
struct LabelSurface {
  TriangleMesh surface;
  double voxel_volume = 0;         // of all voxels of the label [mm^3]
  double surface_volume = 0;       // enclosed [mm^3]
  std::vector<std::string> notes;  // of the reader, and on unusual values
};

// Whether a path is that of an image, by its extension, or a folder, which may hold a DICOM series.
bool IsImagePath(const std::filesystem::path& path);

// Reads an image as ReadVolumeFiles does and makes a surface of the voxels that have the label, smoothed by a Gaussian
// of `smoothing` voxels (standard deviation, 0.3 to 10) with the volume preserved. Adds to `problems` (with empty
// paths) what is wrong with the file, or the existing labels if this one does not exist. Throws Stopped after a stop
// request, which is checked between the parts of VTK's filters.
std::optional<LabelSurface> ReadLabelSurface(const std::filesystem::path& path, int label, double smoothing,
                                             const std::stop_token& stop, Problems& problems);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMAGE_LABEL_SURFACE_H_
