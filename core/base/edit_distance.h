#ifndef FASCICLE_CORE_BASE_EDIT_DISTANCE_H_
#define FASCICLE_CORE_BASE_EDIT_DISTANCE_H_

#include <cstddef>
#include <string_view>

namespace fascicle {

// Fewest insertions, deletions and replacements of bytes that make one text of the other [Levenshtein 1966]. Takes
// time in proportion to the product of their lengths.
std::size_t EditDistance(std::string_view a, std::string_view b);

}  // namespace fascicle

#endif  // FASCICLE_CORE_BASE_EDIT_DISTANCE_H_
