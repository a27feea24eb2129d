#ifndef FASCICLE_CORE_BASE_CHECK_H_
#define FASCICLE_CORE_BASE_CHECK_H_

#include <string_view>

namespace fascicle {

// Prints where and what, then aborts.
[[noreturn]] void CheckFailed(const char* file, int line, const char* condition, std::string_view message);

}  // namespace fascicle

// Ends the program when `condition` is false: a mistake of ours, never of a user's input. On in every build; the
// message is evaluated only then.
#define FASCICLE_CHECK(condition, message)                                \
  do {                                                                    \
    if (!(condition)) [[unlikely]]                                        \
      ::fascicle::CheckFailed(__FILE__, __LINE__, #condition, (message)); \
  } while (false)

#endif  // FASCICLE_CORE_BASE_CHECK_H_
