// Any bytes as what travels between client and server; the first byte selects what: frames and geometry as the client
// decodes them, names and page tokens as the server reads them.
#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include <google/protobuf/stubs/logging.h>

#include "client/lib/decode.h"
#include "core/base/check.h"
#include "server/rpc/names.h"

namespace {

// Every frame is decoded for the shapes of the geometry; errors are exceptions with a text.
void Decode(std::string_view bytes, std::size_t split) {
  fascicle::v1::Geometry geometry;
  fascicle::v1::Frame frame;
  const std::size_t at = split % (bytes.size() + 1);
  if (!geometry.ParseFromString(std::string(bytes.substr(0, at)))) return;
  if (!frame.ParseFromString(std::string(bytes.substr(at)))) return;
  try {
    fascicle::client::DecodeRigidBodies(geometry);
    const std::vector<fascicle::client::BodyShape> shapes = fascicle::client::DecodeGeometry(geometry);
    for (int i = 0; i < frame.bodies_size() && i < static_cast<int>(shapes.size()); ++i) {
      const auto& shape = shapes[static_cast<std::size_t>(i)];
      FASCICLE_CHECK(
          fascicle::client::DecodePositions(frame.bodies(i), shape.positions.size()).size() == shape.positions.size(),
          "a position for each node");
      for (const auto& field : frame.bodies(i).fields()) fascicle::client::DecodeField(field, shape);
    }
  } catch (const std::exception& e) {
    FASCICLE_CHECK(*e.what() != '\0', "errors have a text");
  }
}

void ReadNames(std::string_view text, std::size_t split) {
  using namespace fascicle::server;
  const std::size_t at = split % (text.size() + 1);
  const std::string_view filter = text.substr(0, at), token = text.substr(at);
  if (const auto place = ParsePageToken(token, filter)) {
    FASCICLE_CHECK(MakePageToken(*place, filter) == token, "only tokens of this server are taken");
  }
  if (const auto id = ParseJobName(token)) {
    FASCICLE_CHECK(JobName(*id) == token, "the same id");
    const JobPlace place = {.number = static_cast<std::int64_t>(split), .text = std::string(filter), .id = *id};
    const auto parsed = ParsePageToken(MakePageToken(place, filter), filter);
    FASCICLE_CHECK(parsed && parsed->number == place.number && parsed->text == place.text && parsed->id == *id,
                   "the same place");
  }
  if (const auto digest = ParseAssetName(token)) FASCICLE_CHECK(AssetName(*digest) == token, "the same digest");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  google::protobuf::SetLogHandler(nullptr);  // it would tell of each string that is not UTF-8
  if (size < 3) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 3, size - 3);
  const std::size_t split = data[1] + 256u * data[2];
  data[0] % 2 == 0 ? Decode(rest, split) : ReadNames(rest, split);
  return 0;
}
