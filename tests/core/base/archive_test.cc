#include "core/base/archive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "core/base/digest.h"

namespace fascicle {
namespace {

const std::vector<std::int32_t> kInts = {1, -2, std::numeric_limits<std::int32_t>::min()};
const std::vector<double> kDoubles = {0.1, -0.0, std::numeric_limits<double>::infinity(), 5e-324};
const std::vector<Vec3> kVectors = {{1, 2, 3}, {-0.5, 1e300, 0}};

std::string Sample() {
  ArchiveWriter writer("sample", 3);
  writer.PutInt("step", -42);
  writer.PutDouble("time", 0.1);
  writer.PutString("name", std::string("a\0b", 3));
  writer.PutInts("ints", kInts);
  writer.PutDoubles("doubles", kDoubles);
  writer.PutVectors("vectors", kVectors);
  writer.PutDoubles("none", {});
  return writer.Finish();
}

struct Values {
  std::int64_t step = 0;
  double time = 0;
  std::string name;
  std::vector<std::int32_t> ints;
  std::vector<double> doubles, none = {1};
  std::vector<Vec3> vectors;
};

bool Read(std::string_view bytes, Values& values) {
  ArchiveReader reader(bytes, "sample", 3);
  values.step = reader.GetInt("step");
  values.time = reader.GetDouble("time");
  values.name = reader.GetString("name");
  reader.GetInts("ints", values.ints);
  reader.GetDoubles("doubles", values.doubles);
  reader.GetVectors("vectors", values.vectors);
  reader.GetDoubles("none", values.none);
  EXPECT_EQ(reader.AtEnd(), !reader.failed());
  return reader.AtEnd();
}

// Sets the last four bytes to the CRC of the others.
void Seal(std::string& bytes) {
  const std::uint32_t crc = Crc32c(std::string_view(bytes).substr(0, bytes.size() - 4));
  std::memcpy(bytes.data() + bytes.size() - 4, &crc, 4);
}

TEST(ArchiveTest, RestoresEveryBit) {
  Values values;
  ASSERT_TRUE(Read(Sample(), values));
  EXPECT_EQ(values.step, -42);
  EXPECT_EQ(values.time, 0.1);
  EXPECT_EQ(values.name, std::string("a\0b", 3));
  EXPECT_EQ(values.ints, kInts);
  ASSERT_EQ(values.doubles.size(), kDoubles.size());
  EXPECT_EQ(std::memcmp(values.doubles.data(), kDoubles.data(), sizeof(double) * kDoubles.size()), 0);
  EXPECT_EQ(values.vectors, kVectors);
  EXPECT_TRUE(values.none.empty());
}

TEST(ArchiveTest, FixedSizesMustMatch) {
  const std::string bytes = [] {
    ArchiveWriter writer("w", 1);
    writer.PutDoubles("x", kDoubles);
    return writer.Finish();
  }();
  for (const std::size_t size : {3u, 4u, 5u}) {
    std::vector<double> values(size, 7.0);
    ArchiveReader reader(bytes, "w", 1);
    reader.GetDoubles("x", std::span(values));
    EXPECT_EQ(reader.AtEnd(), size == 4);
    EXPECT_EQ(values[0], size == 4 ? 0.1 : 7.0);
  }
}

TEST(ArchiveTest, EveryCutFails) {
  const std::string bytes = Sample();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    // A copy of exactly this size, so that the address sanitizer detects reads beyond the end.
    std::string cut = bytes.substr(0, size);
    cut.shrink_to_fit();
    Values values;
    EXPECT_FALSE(Read(cut, values)) << size;
    // The same with a correct checksum, so that only the checks of lengths protect.
    if (size < 8) continue;
    Seal(cut);
    EXPECT_FALSE(Read(cut, values)) << size;
  }
}

TEST(ArchiveTest, EveryFlippedBitFails) {
  const std::string bytes = Sample();
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string damaged = bytes;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    Values values;
    EXPECT_FALSE(Read(damaged, values)) << bit;
  }
}

TEST(ArchiveTest, HugeLengthsAllocateNothing) {
  const std::string bytes = [] {
    ArchiveWriter writer("w", 1);
    writer.PutDoubles("x", kDoubles);
    return writer.Finish();
  }();
  const std::size_t length_at = bytes.size() - 4 - sizeof(double) * kDoubles.size() - 8;
  for (const std::uint64_t length : {std::uint64_t{5}, std::uint64_t{1} << 61, ~std::uint64_t{0}}) {
    std::string damaged = bytes;
    std::memcpy(damaged.data() + length_at, &length, 8);
    Seal(damaged);
    std::vector<double> values;
    ArchiveReader reader(damaged, "w", 1);
    reader.GetDoubles("x", values);
    EXPECT_TRUE(reader.failed());
    EXPECT_EQ(values.capacity(), 0u);
  }
}

TEST(ArchiveTest, OtherKindVersionNameTypeOrOrderFails) {
  const std::string bytes = [] {
    ArchiveWriter writer("tet", 2);
    writer.PutInt("step", 1);
    writer.PutInt("frame", 2);
    return writer.Finish();
  }();
  EXPECT_TRUE(ArchiveReader(bytes, "voxel", 2).failed());
  EXPECT_TRUE(ArchiveReader(bytes, "tet", 3).failed());
  ArchiveReader by_name(bytes, "tet", 2);
  EXPECT_EQ(by_name.GetInt("frame"), 0);
  EXPECT_TRUE(by_name.failed());
  EXPECT_EQ(by_name.GetInt("step"), 0) << "failed for good";
  ArchiveReader by_type(bytes, "tet", 2);
  by_type.GetDouble("step");
  EXPECT_TRUE(by_type.failed());
  ArchiveReader unread(bytes, "tet", 2);
  EXPECT_EQ(unread.GetInt("step"), 1);
  EXPECT_FALSE(unread.failed());
  EXPECT_FALSE(unread.AtEnd());
  EXPECT_EQ(unread.GetInt("frame"), 2);
  EXPECT_TRUE(unread.AtEnd());
  unread.Fail();
  EXPECT_FALSE(unread.AtEnd());
}

}  // namespace
}  // namespace fascicle
