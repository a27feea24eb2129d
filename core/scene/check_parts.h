#ifndef FASCICLE_CORE_SCENE_CHECK_PARTS_H_
#define FASCICLE_CORE_SCENE_CHECK_PARTS_H_

#include <algorithm>
#include <string>

#include "core/base/problems.h"
#include "core/scene/shape.h"

namespace fascicle::scene_checks {

// Checks that each element refers to an existing value.
template <class Value>
void CheckParts(const Parts<Value>& parts, std::size_t elements, const std::string& path, Problems& problems) {
  if (parts.of.empty()) return;
  if (parts.of.size() != elements) {
    problems.Add(path, std::to_string(parts.of.size()) + " entries for " + std::to_string(elements) + " elements");
  }
  const auto wrong = std::find_if(parts.of.begin(), parts.of.end(), [&](std::int32_t part) {
    return part < 0 || static_cast<std::size_t>(part) > parts.more.size();
  });
  if (wrong != parts.of.end()) {
    problems.Add(path, "element " + std::to_string(wrong - parts.of.begin()) + " refers to number " +
                           std::to_string(*wrong) + " of " + std::to_string(parts.more.size()));
  }
}

}  // namespace fascicle::scene_checks

#endif  // FASCICLE_CORE_SCENE_CHECK_PARTS_H_
