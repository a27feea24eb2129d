#include "core/base/check.h"

#include <cstdio>
#include <cstdlib>

namespace fascicle {

void CheckFailed(const char* file, int line, const char* condition, std::string_view message) {
  std::fprintf(stderr, "fascicle: bug: %s:%d: %s: %.*s\n", file, line, condition, static_cast<int>(message.size()),
               message.data());
  std::fflush(stderr);
  std::abort();
}

}  // namespace fascicle
