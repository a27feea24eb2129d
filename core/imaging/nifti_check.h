#ifndef FASCICLE_CORE_IMAGING_NIFTI_CHECK_H_
#define FASCICLE_CORE_IMAGING_NIFTI_CHECK_H_

#include <string_view>

#include "core/base/problems.h"

// For this room alone.
namespace fascicle {

inline constexpr std::size_t kNiftiHeader = 352;

// Whether the place of a NIfTI-1 image, in its first kNiftiHeader bytes, is one that ITK can take: its matrix library
// ends the program on numbers that are not finite, as those become that are too large, or too small to divide by.
// False, with problems, otherwise. What is no such header is left to ITK, which says so.
bool CheckNiftiPlace(std::string_view header, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_IMAGING_NIFTI_CHECK_H_
