#include "proto/frames/pack_array.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

namespace fascicle {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are little-endian; swap bytes here");

constexpr int kMostComponents = 9;
constexpr double kHighestCode = 65535;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// The numbers of an array; nothing if it is not a whole number of tuples.
std::optional<std::vector<double>> NumbersOf(std::string_view doubles, int components) {
  if (components < 1 || components > kMostComponents) return std::nullopt;
  if (doubles.size() % (sizeof(double) * static_cast<std::size_t>(components)) != 0) return std::nullopt;
  std::vector<double> numbers(doubles.size() / sizeof(double));
  if (!numbers.empty()) std::memcpy(numbers.data(), doubles.data(), doubles.size());
  return numbers;
}

// Gathers the bytes of equal weight of each component, which compress better than those of one number after another.
template <class Number>
std::string Planes(const std::vector<Number>& numbers, std::size_t components) {
  std::string planes(numbers.size() * sizeof(Number), '\0');
  const auto* const bytes = reinterpret_cast<const char*>(numbers.data());
  char* out = planes.data();
  for (std::size_t b = 0; b < sizeof(Number); ++b) {
    for (std::size_t c = 0; c < components; ++c) {
      for (std::size_t i = c; i < numbers.size(); i += components) *out++ = bytes[i * sizeof(Number) + b];
    }
  }
  return planes;
}

template <class Number>
std::vector<Number> FromPlanes(const std::string& planes, std::size_t components) {
  std::vector<Number> numbers(planes.size() / sizeof(Number));
  auto* const bytes = reinterpret_cast<char*>(numbers.data());
  const char* in = planes.data();
  for (std::size_t b = 0; b < sizeof(Number); ++b) {
    for (std::size_t c = 0; c < components; ++c) {
      for (std::size_t i = c; i < numbers.size(); i += components) bytes[i * sizeof(Number) + b] = *in++;
    }
  }
  return numbers;
}

std::string DoublesOf(const std::vector<double>& numbers) {
  return std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
}

// The range of one component.
struct Range {
  double lowest = 0, highest = 0;
  double step() const { return (highest - lowest) / kHighestCode; }
  // Half a step, the rounding of the codes and of the numbers made of them, and that of tiny steps.
  double error() const {
    return step() * (0.5 + 1e-9) + 4 * kEpsilon * std::max(std::abs(lowest), std::abs(highest)) +
           kHighestCode * std::numeric_limits<double>::denorm_min();
  }
  std::uint16_t CodeOf(double number) const {
    return step() > 0
               ? static_cast<std::uint16_t>(std::clamp(std::round((number - lowest) / step()), 0.0, kHighestCode))
               : std::uint16_t{0};
  }
};

// The range of each component; nothing if a number or a range is not finite.
std::optional<std::vector<Range>> RangesOf(const std::vector<double>& numbers, std::size_t components) {
  std::vector<Range> ranges(components);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    Range& range = ranges[i % components];
    if (!std::isfinite(numbers[i])) return std::nullopt;
    range.lowest = i < components ? numbers[i] : std::min(range.lowest, numbers[i]);
    range.highest = i < components ? numbers[i] : std::max(range.highest, numbers[i]);
  }
  for (const Range& range : ranges) {
    if (!std::isfinite(range.highest - range.lowest)) return std::nullopt;
  }
  return ranges;
}

std::runtime_error Malformed(const std::string& what) {
  return std::runtime_error("the server sent packed numbers " + what);
}

}  // namespace

std::optional<v1::PackedArray> PackFloat32(std::string_view doubles, int components) {
  const auto numbers = NumbersOf(doubles, components);
  if (!numbers) return std::nullopt;
  std::vector<float> rounded;
  rounded.reserve(numbers->size());
  double largest = 0;
  for (const double number : *numbers) {
    if (std::isfinite(number)) {
      if (std::abs(number) > std::numeric_limits<float>::max()) return std::nullopt;
      largest = std::max(largest, std::abs(number));
    }
    rounded.push_back(static_cast<float>(number));
  }
  v1::PackedArray array;
  array.set_format(v1::PackedArray::FORMAT_FLOAT32);
  array.set_components(components);
  array.set_values(Planes(rounded, static_cast<std::size_t>(components)));
  // Half a unit in the last place of 24 bits, and of the least number.
  array.set_max_error(largest * 0x1p-24 + 0x1p-150);
  return array;
}

std::optional<v1::PackedArray> PackQuantized16(std::string_view doubles, int components) {
  const auto numbers = NumbersOf(doubles, components);
  if (!numbers) return std::nullopt;
  const auto width = static_cast<std::size_t>(components);
  const auto ranges = RangesOf(*numbers, width);
  if (!ranges) return std::nullopt;
  std::vector<std::uint16_t> codes;
  codes.reserve(numbers->size());
  for (std::size_t i = 0; i < numbers->size(); ++i) codes.push_back((*ranges)[i % width].CodeOf((*numbers)[i]));
  v1::PackedArray array;
  array.set_format(v1::PackedArray::FORMAT_QUANTIZED16);
  array.set_components(components);
  array.set_values(Planes(codes, width));
  double error = 0;
  for (const Range& range : *ranges) {
    array.add_lowest(range.lowest);
    array.add_step(range.step());
    error = std::max(error, range.error());
  }
  array.set_max_error(error);
  return array;
}

std::string Unpack(const v1::PackedArray& array) {
  const bool is_float = array.format() == v1::PackedArray::FORMAT_FLOAT32;
  if (!is_float && array.format() != v1::PackedArray::FORMAT_QUANTIZED16) {
    throw Malformed("in a format that this program does not know; a newer one may");
  }
  if (array.components() < 1 || array.components() > kMostComponents) throw Malformed("with impossible components");
  const auto components = static_cast<std::size_t>(array.components());
  const std::size_t bytes = is_float ? sizeof(float) : sizeof(std::uint16_t);
  if (array.values().size() % (bytes * components) != 0) throw Malformed("of a wrong size");
  if (is_float) {
    const std::vector<float> numbers = FromPlanes<float>(array.values(), components);
    return DoublesOf({numbers.begin(), numbers.end()});
  }
  if (array.lowest_size() != array.components() || array.step_size() != array.components()) {
    throw Malformed("without their range");
  }
  const std::vector<std::uint16_t> codes = FromPlanes<std::uint16_t>(array.values(), components);
  std::vector<double> numbers(codes.size());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const int c = static_cast<int>(i % components);
    numbers[i] = array.lowest(c) + codes[i] * array.step(c);
  }
  return DoublesOf(numbers);
}

}  // namespace fascicle
