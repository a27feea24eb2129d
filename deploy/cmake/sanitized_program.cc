// For programs under the address sanitizer.
#include <dlfcn.h>

// Mesa's driver is unloaded before the end; what its own variables still point to would then count as leaked, with a
// stack that no one can name. So no library is unloaded.
extern "C" int dlclose(void*) noexcept { return 0; }

// VTK 9.1 does not free the byte that this function of its own returns; ITK 5.2's readers of NRRD and NIfTI keep half a
// kilobyte of files that they refuse.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:vtkGeometryFilterHelper::CharacterizeUnstructuredGrid\n"
         "leak:libITKNrrdIO\n"
         "leak:libITKniftiio\n";
}
