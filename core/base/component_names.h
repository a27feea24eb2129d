#ifndef FASCICLE_CORE_BASE_COMPONENT_NAMES_H_
#define FASCICLE_CORE_BASE_COMPONENT_NAMES_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fascicle {

// The names of a field's components: x y z of a vector, xx yy zz xy yz xz of a symmetric tensor, 1 2 3 of principal
// values, 1x 1y 1z 2x ... of principal directions, an empty name of a scalar, and numbers from 0 of anything else.
inline std::vector<std::string> ComponentNames(std::string_view field, std::size_t components) {
  const bool principal = field.starts_with("principal_");
  if (components == 1) return {""};
  if (components == 3 && principal) return {"1", "2", "3"};
  if (components == 3) return {"x", "y", "z"};
  if (components == 6) return {"xx", "yy", "zz", "xy", "yz", "xz"};
  if (components == 9 && principal) return {"1x", "1y", "1z", "2x", "2y", "2z", "3x", "3y", "3z"};
  std::vector<std::string> names;
  for (std::size_t c = 0; c < components; ++c) names.push_back(std::to_string(c));
  return names;
}

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_COMPONENT_NAMES_H_
