#include "proto/frames/derived_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <stdexcept>
#include <vector>

#include "core/base/digest.h"
#include "proto/frames/frame_digest.h"

namespace fascicle {
namespace {

using Request = v1::StreamFramesRequest;

std::string Waves(int numbers, double size) {
  std::vector<double> values;
  for (int i = 0; i < numbers; ++i) values.push_back(size * std::sin(0.01 * i));
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
}

v1::Frame Sample() {
  v1::Frame frame;
  frame.set_index(3);
  frame.set_time(0.25);
  frame.set_step(17);
  v1::BodyFrame& body = *frame.add_bodies();
  body.set_positions(Waves(3000, 0.1));
  body.set_higher_order_positions(Waves(600, 0.1));
  for (const char* name : {"velocity", "cauchy_stress"}) {
    v1::FieldValues& field = *body.add_fields();
    field.set_name(name);
    field.set_components(3);
    field.set_values(Waves(3000, 1e4));
    field.set_all_values(Waves(3600, 1e4));
  }
  for (const double value : {1.0, 2.0}) frame.add_series(value);
  frame.set_poses(Waves(7, 1));
  frame.add_lines()->set_points(Waves(6, 1));
  frame.set_digest(DigestOfNumbers(frame));
  return frame;
}

Request Ask(std::vector<std::string> fields, Request::Encoding encoding, bool compress) {
  Request request;
  for (const std::string& field : fields) request.add_fields(field);
  request.set_encoding(encoding);
  if (compress) request.set_compression(v1::DerivedFrame::COMPRESSION_ZSTD);
  return request;
}

TEST(DerivedFrame, CompressedFramesAreTheStoredOnes) {
  const std::string stored = Sample().SerializeAsString();
  const v1::DerivedFrame derived = DeriveFrame(stored, Ask({}, Request::ENCODING_STORED, true));
  EXPECT_LT(derived.content().size(), stored.size());
  const v1::Frame frame = ReadDerivedFrame(derived);
  EXPECT_EQ(frame.SerializeAsString(), stored);
  EXPECT_FALSE(frame.has_derivation());
  EXPECT_EQ(frame.digest(), DigestOfNumbers(frame));
}

TEST(DerivedFrame, HasTheSelectedPartsOnly) {
  const v1::Frame sample = Sample();
  const v1::Frame frame =
      ReadDerivedFrame(DeriveFrame(sample.SerializeAsString(), Ask({"velocity"}, Request::ENCODING_STORED, false)));
  EXPECT_TRUE(frame.bodies(0).positions().empty() && frame.bodies(0).higher_order_positions().empty());
  ASSERT_EQ(frame.bodies(0).fields_size(), 1);
  EXPECT_EQ(frame.bodies(0).fields(0).SerializeAsString(), sample.bodies(0).fields(0).SerializeAsString());
  EXPECT_EQ(frame.series_size(), 0);
  EXPECT_EQ(frame.poses(), sample.poses());
  EXPECT_EQ(frame.lines_size(), 1);
  EXPECT_TRUE(frame.digest().empty());
  EXPECT_EQ(frame.derivation().stored_digest(), sample.digest());
  ASSERT_EQ(frame.derivation().fields_size(), 1);

  const v1::Frame both = ReadDerivedFrame(
      DeriveFrame(sample.SerializeAsString(), Ask({"positions", "series"}, Request::ENCODING_STORED, true)));
  EXPECT_EQ(both.bodies(0).positions(), sample.bodies(0).positions());
  EXPECT_EQ(both.bodies(0).fields_size(), 0);
  EXPECT_EQ(both.series_size(), 2);
}

double LargestDifference(const std::string& a, const std::string& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t at = 0; at + 8 <= std::min(a.size(), b.size()); at += 8) {
    double x = 0, y = 0;
    std::memcpy(&x, a.data() + at, 8);
    std::memcpy(&y, b.data() + at, 8);
    largest = std::max(largest, std::abs(x - y));
  }
  return largest;
}

TEST(DerivedFrame, StatesTheErrorOfPositions) {
  const v1::Frame sample = Sample();
  for (const auto& [encoding, most] : {std::pair(Request::ENCODING_FLOAT32, 0.1 * 6e-8),
                                       std::pair(Request::ENCODING_QUANTIZED16, 0.1 / 65535 * 1.01)}) {
    const v1::Frame frame = ReadDerivedFrame(DeriveFrame(sample.SerializeAsString(), Ask({}, encoding, true)));
    const double error = LargestDifference(frame.bodies(0).positions(), sample.bodies(0).positions());
    EXPECT_GT(error, 0);
    EXPECT_LE(error, frame.derivation().position_error());
    EXPECT_LE(LargestDifference(frame.bodies(0).higher_order_positions(), sample.bodies(0).higher_order_positions()),
              frame.derivation().position_error());
    EXPECT_LE(frame.derivation().position_error(), most);
    EXPECT_LE(LargestDifference(frame.bodies(0).fields(1).all_values(), sample.bodies(0).fields(1).all_values()),
              1e4 * 6e-8);
    EXPECT_FALSE(frame.bodies(0).has_packed_positions() || frame.bodies(0).fields(0).has_packed_values());
    EXPECT_TRUE(std::equal(frame.series().begin(), frame.series().end(), sample.series().begin()));
  }
}

TEST(DerivedFrame, EqualRequestsGiveEqualBytes) {
  const std::string stored = Sample().SerializeAsString();
  const Request request = Ask({"positions"}, Request::ENCODING_QUANTIZED16, true);
  EXPECT_EQ(DeriveFrame(stored, request).SerializeAsString(), DeriveFrame(stored, request).SerializeAsString());
}

// One flipped bit anywhere is noticed, except where it changes nothing that is read.
TEST(DerivedFrame, FlippedBitsAreNoticed) {
  const std::string stored = Sample().SerializeAsString();
  std::mt19937_64 random(18);
  for (const auto encoding : {Request::ENCODING_STORED, Request::ENCODING_QUANTIZED16}) {
    for (const bool compress : {false, true}) {
      if (encoding == Request::ENCODING_STORED && !compress) continue;
      const std::string sent = DeriveFrame(stored, Ask({}, encoding, compress)).SerializeAsString();
      const std::string right = ReadDerivedFrame(DeriveFrame(stored, Ask({}, encoding, compress))).SerializeAsString();
      for (int i = 0; i < 1000; ++i) {
        std::string flipped = sent;
        flipped[random() % flipped.size()] ^= static_cast<char>(1 << random() % 8);
        v1::DerivedFrame derived;
        if (!derived.ParseFromString(flipped)) continue;
        try {
          EXPECT_TRUE(ReadDerivedFrame(derived).SerializeAsString() == right);
        } catch (const std::runtime_error&) {
          continue;  // noticed
        }
      }
    }
  }
}

TEST(DerivedFrame, FalseSizesAreRefused) {
  const std::string stored(1 << 20, '\0');  // compresses well
  v1::DerivedFrame derived = DeriveFrame(stored, Ask({}, Request::ENCODING_STORED, true));
  for (const std::int64_t size :
       {std::int64_t{-1}, std::int64_t{0}, std::int64_t{100}, kLargestDerived, kLargestDerived + 1}) {
    derived.set_content_size(size);
    EXPECT_THROW(ReadDerivedFrame(derived), std::runtime_error) << size;
  }
  derived = DeriveFrame(stored, Ask({}, Request::ENCODING_STORED, true));
  derived.mutable_content()->append("more");
  EXPECT_THROW(ReadDerivedFrame(derived), std::runtime_error);
  derived.set_compression(static_cast<v1::DerivedFrame::Compression>(7));
  EXPECT_THROW(ReadDerivedFrame(derived), std::runtime_error);
}

}  // namespace
}  // namespace fascicle
