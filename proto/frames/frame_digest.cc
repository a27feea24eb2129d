#include "proto/frames/frame_digest.h"

#include <span>

#include "core/base/frame_digest.h"

namespace fascicle {
namespace {

FrameBytes::Bytes BytesOf(const std::string& text) { return std::as_bytes(std::span(text)); }

FrameBytes::Bytes BytesOf(const google::protobuf::RepeatedField<double>& values) {
  return std::as_bytes(std::span(values.data(), static_cast<std::size_t>(values.size())));
}

}  // namespace

std::string DigestOfNumbers(const v1::Frame& frame) {
  FrameBytes bytes;
  bytes.index = frame.index();
  bytes.time = frame.time();
  bytes.step = frame.step();
  for (const v1::BodyFrame& body : frame.bodies()) {
    FrameBytes::Body& of_body = bytes.bodies.emplace_back();
    of_body.positions = BytesOf(body.positions());
    of_body.higher_order_positions = BytesOf(body.higher_order_positions());
    for (const v1::FieldValues& field : body.fields()) {
      of_body.fields.push_back({field.name(), BytesOf(field.values()), BytesOf(field.all_values())});
    }
  }
  bytes.series = BytesOf(frame.series());
  bytes.poses = BytesOf(frame.poses());
  for (const v1::LineFrame& line : frame.lines()) {
    bytes.lines.push_back({BytesOf(line.points()), BytesOf(line.values())});
  }
  const Digest digest = DigestOf(bytes);
  return std::string(digest.begin(), digest.end());
}

}  // namespace fascicle
