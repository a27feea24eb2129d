#ifndef FASCICLE_CORE_IMAGING_DICOM_CHECK_H_
#define FASCICLE_CORE_IMAGING_DICOM_CHECK_H_

#include <string_view>

#include "core/base/problems.h"

// For this room alone.
namespace fascicle {

// Whether bytes are a whole DICOM file with one image of numbers: preamble, elements of known types that nest and end
// where they say (explicit and implicit, either byte order), rows, columns, and as many bytes of voxels as these need.
// GDCM, as it is built for Debian, ends the program on files that are not. Adds to `problems` what is wrong.
bool CheckDicom(std::string_view bytes, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_DICOM_CHECK_H_
