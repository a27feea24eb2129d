#ifndef FASCICLE_CORE_IMAGING_NIFTI_CHECK_H_
#define FASCICLE_CORE_IMAGING_NIFTI_CHECK_H_

#include <string_view>

#include "core/base/problems.h"

// Internal to this room.
namespace fascicle {

inline constexpr std::size_t kNiftiHeader = 352;

// Whether the position and axes of a NIfTI-1 image, given by its first kNiftiHeader bytes, are acceptable to ITK. ITK's
// matrix library aborts the program on non-finite numbers, which also result from numbers that are too large, or too
// small to divide by. If not, returns false and adds problems. Bytes that are not such a header are left to ITK, which
// reports that.
bool CheckNiftiPlace(std::string_view header, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_NIFTI_CHECK_H_
