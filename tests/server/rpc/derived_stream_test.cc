// Frames that StreamFrames selects, rounds and compresses.
#include <algorithm>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "proto/frames/derived_frame.h"
#include "proto/frames/frame_digest.h"
#include "server/rpc/shared_cache.h"
#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

using Request = v1::StreamFramesRequest;

struct Derived {
  std::optional<v1::StreamFramesResponse::Header> header;
  std::vector<v1::Frame> frames;
  std::size_t bytes = 0;  // of all chunks
  bool ended = false;
  grpc::Status status;
};

Derived ReadDerived(Stubs& stubs, const Request& request) {
  Derived read;
  grpc::ClientContext context;
  const auto reader = stubs.frames->StreamFrames(&context, request);
  v1::StreamFramesResponse message;
  std::string bytes;
  while (reader->Read(&message)) {
    if (message.has_header()) read.header = message.header();
    read.ended = message.has_end();
    if (!message.has_chunk()) continue;
    EXPECT_EQ(message.chunk().offset(), static_cast<std::int64_t>(bytes.size()));
    EXPECT_LE(message.chunk().data().size(), std::size_t{1} << 20);
    EXPECT_EQ(message.chunk().crc32c(), Crc32c(message.chunk().data()));
    bytes += message.chunk().data();
    if (!message.chunk().last()) continue;
    v1::DerivedFrame derived;
    EXPECT_TRUE(derived.ParseFromString(bytes));
    read.frames.push_back(ReadDerivedFrame(derived));
    EXPECT_EQ(read.frames.back().index(), message.chunk().frame_index());
    read.bytes += bytes.size();
    bytes.clear();
  }
  read.status = reader->Finish();
  return read;
}

class DerivedStreamTest : public ServiceTest {
 protected:
  std::string Job(v1::Scene scene) {
    scene.mutable_output()->add_fields(v1::FIELD_VELOCITY);
    std::string name = stubs_->Submit(scene);
    EXPECT_TRUE(stubs_->AwaitState(name, v1::Job::STATE_SUCCEEDED));
    return name;
  }
};

TEST_F(DerivedStreamTest, CompressedFramesHaveTheDigestsOfTheStoredOnes) {
  const std::string name = Job(SwingingBox(0.1, 0.01));
  Request request = AllFramesOf(name);
  request.set_compression(v1::DerivedFrame::COMPRESSION_ZSTD);
  request.set_stride(2);
  const Derived read = ReadDerived(*stubs_, request);
  ASSERT_TRUE(read.status.ok()) << read.status.error_message();
  EXPECT_TRUE(read.header && read.header->derived() && read.ended);
  const std::vector<v1::FrameInfo> stored = stubs_->List(name);
  ASSERT_EQ(read.frames.size(), 6u);
  for (std::size_t i = 0; i < read.frames.size(); ++i) {
    EXPECT_EQ(read.frames[i].digest(), stored[2 * i].digest());
    EXPECT_EQ(DigestOfNumbers(read.frames[i]), stored[2 * i].digest());
  }
}

TEST_F(DerivedStreamTest, SelectedFieldsOnly) {
  const std::string name = Job(SwingingBox(0.1, 0.01));
  Request request = AllFramesOf(name);
  request.add_fields("velocity");
  const Derived read = ReadDerived(*stubs_, request);
  ASSERT_TRUE(read.status.ok()) << read.status.error_message();
  const std::vector<v1::Frame> whole = ReadStream(*stubs_, AllFramesOf(name)).frames;
  ASSERT_EQ(read.frames.size(), whole.size());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    ASSERT_EQ(read.frames[i].bodies(0).fields_size(), 1);
    EXPECT_EQ(read.frames[i].bodies(0).fields(0).values(), whole[i].bodies(0).fields(0).values());
    EXPECT_TRUE(read.frames[i].bodies(0).positions().empty());
    EXPECT_EQ(read.frames[i].series_size(), 0);
    EXPECT_EQ(read.frames[i].derivation().stored_digest(), whole[i].digest());
  }
}

TEST_F(DerivedStreamTest, AllErrorsAtOnceWithWhatThereIs) {
  const std::string name = Job(SwingingBox(0.1, 0.05));
  Request request = AllFramesOf(name);
  request.add_fields("velocity");
  request.add_fields("speed");
  request.add_fields("cauchy_stress");  // known, but not of this job
  request.set_encoding(static_cast<Request::Encoding>(8));
  request.set_compression(static_cast<v1::DerivedFrame::Compression>(9));
  const grpc::Status status = ReadDerived(*stubs_, request).status;
  EXPECT_EQ(ReasonOf(status), "3 INVALID_ARGUMENT");
  const auto bad = DetailOf<google::rpc::BadRequest>(status);
  ASSERT_TRUE(bad);
  std::map<std::string, std::string> told;
  for (const auto& violation : bad->field_violations()) told[violation.field()] = violation.description();
  EXPECT_EQ(told.size(), 4u);
  EXPECT_NE(told["fields[1]"].find("positions, series, velocity"), std::string::npos) << told["fields[1]"];
  EXPECT_TRUE(told.contains("fields[2]") && told.contains("encoding") && told.contains("compression"));
}

// Prints the table of the README.
TEST_F(DerivedStreamTest, BytesOfAFrame) {
  const std::string name = Job(LargeFrames(3));
  const std::vector<v1::Frame> whole = ReadStream(*stubs_, AllFramesOf(name)).frames;
  const std::size_t count = whole.size();
  ASSERT_GE(count, 3u);
  std::size_t stored = 0;
  for (const v1::Frame& frame : whole) stored += frame.ByteSizeLong();
  std::printf("%-40s %9zu bytes a frame\n", "as stored", stored / count);
  std::map<std::string, std::size_t> bytes;
  struct Form {
    const char* name;
    Request::Encoding encoding;
    bool compress;
    std::vector<std::string> fields;
  };
  for (const Form& form : {Form{"as stored, zstd", Request::ENCODING_STORED, true, {}},
                           Form{"float32", Request::ENCODING_FLOAT32, false, {}},
                           Form{"float32, zstd", Request::ENCODING_FLOAT32, true, {}},
                           Form{"quantized16", Request::ENCODING_QUANTIZED16, false, {}},
                           Form{"quantized16, zstd", Request::ENCODING_QUANTIZED16, true, {}},
                           Form{"positions", Request::ENCODING_STORED, false, {"positions"}},
                           Form{"positions, quantized16", Request::ENCODING_QUANTIZED16, false, {"positions"}},
                           Form{"positions, quantized16, zstd", Request::ENCODING_QUANTIZED16, true, {"positions"}},
                           Form{"series", Request::ENCODING_STORED, false, {"series"}}}) {
    Request request = AllFramesOf(name);
    request.set_encoding(form.encoding);
    if (form.compress) request.set_compression(v1::DerivedFrame::COMPRESSION_ZSTD);
    for (const std::string& field : form.fields) request.add_fields(field);
    const Derived read = ReadDerived(*stubs_, request);
    ASSERT_TRUE(read.status.ok()) << read.status.error_message();
    ASSERT_EQ(read.frames.size(), count);
    bytes[form.name] = read.bytes / count;
    std::printf("%-40s %9zu bytes a frame\n", form.name, bytes[form.name]);
  }
  EXPECT_LT(bytes["as stored, zstd"], stored / count);
  EXPECT_LT(bytes["float32"], stored / count * 51 / 100);
  EXPECT_LT(bytes["positions, quantized16"], bytes["positions"] * 26 / 100 + 1000);
  EXPECT_LT(bytes["quantized16, zstd"], bytes["float32, zstd"]);
  EXPECT_LT(bytes["series"], 1000u);
}

// What is kept has a bound, and readers that come late share what was made.
TEST(SharedCacheTest, MakesOnceAndForgetsWhatWasNotUsed) {
  server::SharedCache<std::string> cache(1000);
  std::map<std::string, int> made;
  const auto get = [&](const std::string& key) {
    return *cache.Get(key, [&] {
      ++made[key];
      return std::string(400, key[0]);
    });
  };
  EXPECT_EQ(get("a"), std::string(400, 'a'));
  get("b");
  get("a");
  EXPECT_EQ(made["a"], 1);
  get("c");  // b goes, which was used least recently
  get("a");
  EXPECT_EQ(made["a"], 1);
  get("b");
  EXPECT_EQ(made["b"], 2);
  EXPECT_THROW(cache.Get("d", []() -> std::string { throw std::runtime_error("no"); }), std::runtime_error);
  EXPECT_EQ(get("d"), std::string(400, 'd')) << "a failure is not kept";
  cache.DropUnused(1h);
  get("d");
  EXPECT_EQ(made["d"], 1);
  cache.DropUnused(0s);
  get("d");
  EXPECT_EQ(made["d"], 2);
}

}  // namespace
}  // namespace fascicle::service_test
