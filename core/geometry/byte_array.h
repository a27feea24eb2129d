#ifndef FASCICLE_CORE_GEOMETRY_BYTE_ARRAY_H_
#define FASCICLE_CORE_GEOMETRY_BYTE_ARRAY_H_

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace fascicle {

// Number type of an array in a VTK file.
enum class NumberType { kInt8, kUInt8, kInt16, kUInt16, kInt32, kUInt32, kInt64, kUInt64, kFloat32, kFloat64 };

std::size_t SizeOf(NumberType type);

// Converts `bytes`, whose size is a multiple of the number's size. Integers outside of std::int64_t and non-integer
// floating-point values become the largest std::int64_t, which is neither a valid index nor a valid tag.
std::vector<double> ToDoubles(std::string_view bytes, NumberType type, bool big_endian);
std::vector<std::int64_t> ToInts(std::string_view bytes, NumberType type, bool big_endian);
std::vector<std::int64_t> WholeNumbers(const std::vector<double>& values);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_BYTE_ARRAY_H_
