#ifndef FASCICLE_CORE_BASE_CHECK_H_
#define FASCICLE_CORE_BASE_CHECK_H_

#include <string_view>

namespace fascicle {

// Prints the place and the message, then aborts.
[[noreturn]] void CheckFailed(const char* file, int line, const char* condition, std::string_view message);

}  // namespace fascicle

// Aborts the program when `condition` is false: an error in fascicle itself, never in a user's input. Active in every
// build; the message is evaluated only on failure.
#define FASCICLE_CHECK(condition, message)                                \
  do {                                                                    \
    if (!(condition)) [[unlikely]]                                        \
      ::fascicle::CheckFailed(__FILE__, __LINE__, #condition, (message)); \
  } while (false)

#endif  // FASCICLE_CORE_BASE_CHECK_H_
