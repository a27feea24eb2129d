#include "tests/support/paths.h"

#include <cstdlib>

namespace fascicle::testing {
namespace {

std::filesystem::path FolderOf(const char* variable, const char* beside) {
  const char* folder = std::getenv(variable);
  return folder != nullptr ? std::filesystem::path(folder) : ProjectRoot() / ".." / "shared" / beside;
}

}  // namespace

std::filesystem::path ProjectRoot() { return FASCICLE_ROOT; }

std::string Program(const std::string& name) { return std::string(FASCICLE_PROGRAMS) + "/" + name; }

std::filesystem::path DataFolder() { return FolderOf("FASCICLE_DATA", "data"); }

std::filesystem::path ReferenceFolder() { return FolderOf("FASCICLE_REFERENCE", "reference"); }

std::filesystem::path CasesFolder() { return FolderOf("FASCICLE_CASES", "cases"); }

}  // namespace fascicle::testing
