#ifndef FASCICLE_CORE_IMAGING_DICOM_CHECK_H_
#define FASCICLE_CORE_IMAGING_DICOM_CHECK_H_

#include <string_view>

#include "core/base/problems.h"

// Internal to this room.
namespace fascicle {

// Whether the bytes are a complete DICOM file with one image of numbers: a preamble, elements of known types that nest
// and end correctly (explicit and implicit, either byte order), rows, columns, and as many bytes of voxels as these
// require. Debian's build of GDCM aborts the program on malformed files, so they are checked first. Adds to `problems`
// what is wrong.
bool CheckDicom(std::string_view bytes, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_DICOM_CHECK_H_
