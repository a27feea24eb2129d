#include "proto/frames/pack_array.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

namespace fascicle {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::string BytesOf(const std::vector<double>& numbers) {
  return std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
}

std::vector<double> NumbersOf(const std::string& bytes) {
  std::vector<double> numbers(bytes.size() / sizeof(double));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

double LargestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

// Points around a place far from the origin, within a box of very different sides.
std::vector<double> Points(int count, double place, double size, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> along(0, 1);
  std::vector<double> numbers;
  for (int i = 0; i < count; ++i) {
    for (const double side : {size, size * 1e-3, size * 30}) numbers.push_back(place + side * along(random));
  }
  return numbers;
}

TEST(PackArray, QuantizedNumbersKeepTheStatedBound) {
  for (const double place : {0.0, -3.0, 1e6}) {
    for (const double size : {1e-300, 1e-9, 0.2, 1e5}) {
      const std::vector<double> numbers = Points(500, place, size, 7);
      const auto packed = PackQuantized16(BytesOf(numbers), 3);
      ASSERT_TRUE(packed);
      EXPECT_EQ(packed->values().size(), 2 * numbers.size());
      const double error = LargestDifference(NumbersOf(Unpack(*packed)), numbers);
      EXPECT_LE(error, packed->max_error()) << place << ' ' << size;
      // Half a step of the longest side, and what rounding adds.
      EXPECT_LE(packed->max_error(), 30 * size / 65535 / 2 * 1.001 + 1e-15 * std::abs(place) + 1e-318);
    }
  }
}

TEST(PackArray, TheBoundIsReached) {
  const auto packed = PackQuantized16(BytesOf({0.0, 0.5, 65535.0}), 1);
  ASSERT_TRUE(packed);
  EXPECT_NEAR(packed->max_error(), 0.5, 1e-8);
  EXPECT_EQ(LargestDifference(NumbersOf(Unpack(*packed)), {0.0, 0.5, 65535.0}), 0.5);
}

TEST(PackArray, SinglePrecisionKeepsTheStatedBound) {
  const std::vector<double> numbers = Points(500, 4, 0.1, 8);
  const auto packed = PackFloat32(BytesOf(numbers), 3);
  ASSERT_TRUE(packed);
  EXPECT_EQ(packed->values().size(), 4 * numbers.size());
  const std::vector<double> back = NumbersOf(Unpack(*packed));
  for (std::size_t i = 0; i < numbers.size(); ++i)
    EXPECT_EQ(back[i], static_cast<double>(static_cast<float>(numbers[i])));
  EXPECT_LE(LargestDifference(back, numbers), packed->max_error());
  EXPECT_LT(packed->max_error(), 8 * 6e-8);
  const auto tiny = PackFloat32(BytesOf({1e-320, 3e-46}), 1);
  ASSERT_TRUE(tiny);
  EXPECT_LE(LargestDifference(NumbersOf(Unpack(*tiny)), {1e-320, 3e-46}), tiny->max_error());
}

TEST(PackArray, InfiniteNumbersStayInSinglePrecisionOnly) {
  const std::vector<double> numbers = {1, -kInfinity, 3, std::nan("")};
  EXPECT_FALSE(PackQuantized16(BytesOf(numbers), 1));
  const auto packed = PackFloat32(BytesOf(numbers), 1);
  ASSERT_TRUE(packed);
  const std::vector<double> back = NumbersOf(Unpack(*packed));
  EXPECT_EQ(back[1], -kInfinity);
  EXPECT_TRUE(std::isnan(back[3]));
}

TEST(PackArray, WhatDoesNotFitIsNotPacked) {
  EXPECT_FALSE(PackFloat32(BytesOf({1e39}), 1)) << "beyond single precision";
  EXPECT_FALSE(PackQuantized16(BytesOf({-1.7e308, 1.7e308}), 1)) << "the difference overflows";
  EXPECT_FALSE(PackFloat32(BytesOf({1, 2, 3, 4}), 3)) << "no whole number of tuples";
  EXPECT_FALSE(PackFloat32(std::string(7, 'x'), 1));
  EXPECT_FALSE(PackFloat32(BytesOf({1}), 0));
  EXPECT_FALSE(PackQuantized16(BytesOf({1}), 10));
}

TEST(PackArray, OnePointHasNoError) {
  const auto packed = PackQuantized16(BytesOf({1, 2, 3}), 3);
  ASSERT_TRUE(packed);
  EXPECT_EQ(NumbersOf(Unpack(*packed)), (std::vector<double>{1, 2, 3}));
}

TEST(PackArray, MalformedArraysAreRefused) {
  const v1::PackedArray good = *PackQuantized16(BytesOf(Points(10, 0, 1, 9)), 3);
  const auto refuses = [&](const auto& change) {
    v1::PackedArray bad = good;
    change(bad);
    EXPECT_THROW(Unpack(bad), std::runtime_error) << bad.ShortDebugString();
  };
  refuses([](v1::PackedArray& a) { a.clear_format(); });
  refuses([](v1::PackedArray& a) { a.set_format(static_cast<v1::PackedArray::Format>(9)); });
  refuses([](v1::PackedArray& a) { a.set_components(0); });
  refuses([](v1::PackedArray& a) { a.set_components(-3); });
  refuses([](v1::PackedArray& a) { a.set_components(10); });
  refuses([](v1::PackedArray& a) { a.mutable_values()->pop_back(); });
  refuses([](v1::PackedArray& a) { a.mutable_step()->RemoveLast(); });
  refuses([](v1::PackedArray& a) { a.add_lowest(0); });
}

}  // namespace
}  // namespace fascicle
