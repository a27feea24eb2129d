#include "core/geometry/byte_array.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

namespace fascicle {
namespace {

static_assert(std::endian::native == std::endian::little);

template <class From>
From Load(const char* data, bool big_endian) {
  char bytes[sizeof(From)];
  std::memcpy(bytes, data, sizeof(From));
  if (big_endian) std::reverse(bytes, bytes + sizeof(From));
  From value;
  std::memcpy(&value, bytes, sizeof(From));
  return value;
}

template <class To, class From>
To Convert(From value) {
  if constexpr (std::is_same_v<To, double>) {
    return static_cast<double>(value);
  } else if constexpr (std::is_floating_point_v<From>) {
    const bool whole = std::abs(value) < From(1e15) && value == std::floor(value);
    return whole ? static_cast<To>(value) : std::numeric_limits<To>::max();
  } else if constexpr (std::is_same_v<From, std::uint64_t>) {
    return static_cast<To>(std::min(value, std::uint64_t(std::numeric_limits<To>::max())));
  } else {
    return static_cast<To>(value);
  }
}

template <class To, class From>
std::vector<To> ConvertAll(std::string_view bytes, bool big_endian) {
  std::vector<To> values(bytes.size() / sizeof(From));
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = Convert<To>(Load<From>(bytes.data() + i * sizeof(From), big_endian));
  }
  return values;
}

template <class To>
std::vector<To> ConvertFrom(std::string_view bytes, NumberType type, bool big_endian) {
  switch (type) {
    case NumberType::kInt8:
      return ConvertAll<To, std::int8_t>(bytes, big_endian);
    case NumberType::kUInt8:
      return ConvertAll<To, std::uint8_t>(bytes, big_endian);
    case NumberType::kInt16:
      return ConvertAll<To, std::int16_t>(bytes, big_endian);
    case NumberType::kUInt16:
      return ConvertAll<To, std::uint16_t>(bytes, big_endian);
    case NumberType::kInt32:
      return ConvertAll<To, std::int32_t>(bytes, big_endian);
    case NumberType::kUInt32:
      return ConvertAll<To, std::uint32_t>(bytes, big_endian);
    case NumberType::kInt64:
      return ConvertAll<To, std::int64_t>(bytes, big_endian);
    case NumberType::kUInt64:
      return ConvertAll<To, std::uint64_t>(bytes, big_endian);
    case NumberType::kFloat32:
      return ConvertAll<To, float>(bytes, big_endian);
    case NumberType::kFloat64:
      return ConvertAll<To, double>(bytes, big_endian);
  }
  return {};
}

}  // namespace

std::size_t SizeOf(NumberType type) {
  switch (type) {
    case NumberType::kInt8:
    case NumberType::kUInt8:
      return 1;
    case NumberType::kInt16:
    case NumberType::kUInt16:
      return 2;
    case NumberType::kInt32:
    case NumberType::kUInt32:
    case NumberType::kFloat32:
      return 4;
    default:
      return 8;
  }
}

std::vector<double> ToDoubles(std::string_view bytes, NumberType type, bool big_endian) {
  return ConvertFrom<double>(bytes, type, big_endian);
}

std::vector<std::int64_t> ToInts(std::string_view bytes, NumberType type, bool big_endian) {
  return ConvertFrom<std::int64_t>(bytes, type, big_endian);
}

std::vector<std::int64_t> WholeNumbers(const std::vector<double>& values) {
  std::vector<std::int64_t> whole(values.size());
  std::transform(values.begin(), values.end(), whole.begin(), Convert<std::int64_t, double>);
  return whole;
}

}  // namespace fascicle
