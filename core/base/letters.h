#ifndef FASCICLE_CORE_BASE_LETTERS_H_
#define FASCICLE_CORE_BASE_LETTERS_H_

#include <string>
#include <string_view>

namespace fascicle {

// `text` in lower case; letters beyond ASCII stay as they are, in any locale.
inline std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

// The last extension of a file's name with its dot, in lower case: ".obj"; empty if the name has none.
inline std::string LowerExtension(std::string_view name) {
  const std::size_t dot = name.substr(name.find_last_of('/') + 1).rfind('.');
  return dot == std::string_view::npos ? std::string() : Lower(name.substr(name.find_last_of('/') + 1 + dot));
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_LETTERS_H_
