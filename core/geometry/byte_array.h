#ifndef FASCICLE_CORE_GEOMETRY_BYTE_ARRAY_H_
#define FASCICLE_CORE_GEOMETRY_BYTE_ARRAY_H_

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace fascicle {

// Type of the numbers of an array in a VTK file.
enum class NumberType { kInt8, kUInt8, kInt16, kUInt16, kInt32, kUInt32, kInt64, kUInt64, kFloat32, kFloat64 };

std::size_t SizeOf(NumberType type);

// The numbers in `bytes`, of which there must be whole ones. Integers beyond 64 bits of sign and floating-point numbers
// that are not whole become the largest std::int64_t, which is no index and no tag.
std::vector<double> ToDoubles(std::string_view bytes, NumberType type, bool big_endian);
std::vector<std::int64_t> ToInts(std::string_view bytes, NumberType type, bool big_endian);
std::vector<std::int64_t> WholeNumbers(const std::vector<double>& values);

}  // namespace fascicle

#endif  // FASCICLE_CORE_GEOMETRY_BYTE_ARRAY_H_
