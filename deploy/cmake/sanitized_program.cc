// For programs under the address sanitizer.
#include <dlfcn.h>

// Mesa's driver is unloaded before the program ends. Memory that its variables refer to would then count as leaked,
// with a stack that cannot be symbolized. So no library is unloaded.
extern "C" int dlclose(void*) noexcept { return 0; }

// VTK 9.1 does not free the byte returned by this function of its own. ITK 5.2's readers of NRRD and NIfTI leak half a
// kilobyte of files that they refuse.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:vtkGeometryFilterHelper::CharacterizeUnstructuredGrid\n"
         "leak:libITKNrrdIO\n"
         "leak:libITKniftiio\n";
}
