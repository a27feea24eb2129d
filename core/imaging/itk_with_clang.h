#ifndef FASCICLE_CORE_IMAGING_ITK_WITH_CLANG_H_
#define FASCICLE_CORE_IMAGING_ITK_WITH_CLANG_H_

// ITK as Debian installs it compiles with GCC alone, which it asks for in a header of its own. Clang (of the fuzz
// targets) takes the same code: told that it is GCC there, it is let in. Included before all else by the build.
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
