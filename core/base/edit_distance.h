#ifndef FASCICLE_CORE_BASE_EDIT_DISTANCE_H_
#define FASCICLE_CORE_BASE_EDIT_DISTANCE_H_

#include <cstddef>
#include <string_view>

namespace fascicle {

// The least number of insertions, deletions and replacements of bytes that turn one text into the other [Levenshtein
// 1966]. The time is proportional to the product of the lengths.
std::size_t EditDistance(std::string_view a, std::string_view b);

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_EDIT_DISTANCE_H_
