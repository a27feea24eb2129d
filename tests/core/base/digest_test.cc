#include "core/base/digest.h"

#include <gtest/gtest.h>

#include <string>

namespace fascicle {
namespace {

std::string SomeBytes(std::size_t size) {
  std::string bytes(size, '\0');
  std::uint32_t state = 12345;
  for (char& byte : bytes) {
    state = state * 1664525u + 1013904223u;
    byte = static_cast<char>(state >> 24);
  }
  return bytes;
}

// FIPS 180-4 examples.
TEST(Sha256Test, KnownVectors) {
  EXPECT_EQ(Hex(Sha256Of("")), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(Hex(Sha256Of("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Hex(Sha256Of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(Hex(Sha256Of(std::string(1000000, 'a'))),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256Test, PiecesGiveTheSame) {
  const std::string bytes = SomeBytes(1000);
  for (const std::size_t piece : {1u, 7u, 64u, 999u}) {
    Sha256 sha;
    for (std::size_t at = 0; at < bytes.size(); at += piece) sha.Update(std::string_view(bytes).substr(at, piece));
    EXPECT_EQ(sha.Finish(), Sha256Of(bytes)) << piece;
  }
}

// RFC 3720, B.4.
TEST(Crc32cTest, KnownVectors) {
  std::string ascending, descending;
  for (int i = 0; i < 32; ++i) {
    ascending += static_cast<char>(i);
    descending += static_cast<char>(31 - i);
  }
  for (const auto crc : {&Crc32c, &Crc32cByTable}) {
    EXPECT_EQ(crc("", 0), 0u);
    EXPECT_EQ(crc("123456789", 0), 0xE3069283u);
    EXPECT_EQ(crc(std::string(32, '\0'), 0), 0x8A9136AAu);
    EXPECT_EQ(crc(std::string(32, '\xff'), 0), 0x62A8AB43u);
    EXPECT_EQ(crc(ascending, 0), 0x46DD794Eu);
    EXPECT_EQ(crc(descending, 0), 0x113FDB5Cu);
  }
}

TEST(Crc32cTest, FastWayEqualsTable) {
  const std::string bytes = SomeBytes(20000);
  for (std::size_t size = 0; size <= bytes.size(); size = size < 100 ? size + 1 : size * 5 / 4) {
    for (const std::size_t offset : {0u, 1u, 5u}) {
      const std::string_view part = std::string_view(bytes).substr(offset, size);
      EXPECT_EQ(Crc32c(part, 0x12345678u), Crc32cByTable(part, 0x12345678u)) << size;
    }
  }
}

TEST(Crc32cTest, ContinuesFromThePieceBefore) {
  const std::string bytes = SomeBytes(10000);
  const std::string_view all = bytes;
  for (const std::size_t cut : {0u, 1u, 3072u, 9999u, 10000u}) {
    EXPECT_EQ(Crc32c(all.substr(cut), Crc32c(all.substr(0, cut))), Crc32c(all));
  }
}

}  // namespace
}  // namespace fascicle
