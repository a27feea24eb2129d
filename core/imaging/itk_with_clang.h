#ifndef FASCICLE_CORE_IMAGING_ITK_WITH_CLANG_H_
#define FASCICLE_CORE_IMAGING_ITK_WITH_CLANG_H_

// Debian's ITK compiles with GCC only, which one of its headers checks. Clang (for the fuzz targets) accepts the same
// code if it poses as GCC there. The build includes this file before all others.
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wbuiltin-macro-redefined"
#pragma push_macro("__clang__")
#pragma push_macro("__GNUC__")
#undef __clang__
#undef __GNUC__
#define __GNUC__ 12
#include <itk_compiler_detection.h>
#pragma pop_macro("__GNUC__")
#pragma pop_macro("__clang__")
#pragma clang diagnostic pop

#endif  // FASCICLE_CORE_IMAGING_ITK_WITH_CLANG_H_
