#include "core/sim/frame.h"

#include <span>
#include <utility>

#include "core/base/frame_digest.h"

namespace fascicle {
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Pose) == 7 * sizeof(double), "packed, as in digests");

template <class Item>
FrameBytes::Bytes BytesOf(const std::vector<Item>& items) {
  return std::as_bytes(std::span(items));
}

}  // namespace

FieldValues FieldOf(OutputField field, FieldLocation location, std::vector<double> values) {
  const OutputFieldInfo& info = InfoOf(field);
  return {info.name, location, static_cast<int>(info.components), info.unit, std::move(values)};
}

Digest DigestOf(const Frame& frame) {
  FrameBytes bytes;
  bytes.index = frame.index;
  bytes.time = frame.time;
  bytes.step = frame.step;
  for (const BodyFrame& body : frame.bodies) {
    FrameBytes::Body& of_body = bytes.bodies.emplace_back();
    of_body.positions = BytesOf(body.positions);
    of_body.higher_order_positions = BytesOf(body.higher_order_positions);
    for (const FieldValues& field : body.fields) {
      of_body.fields.push_back({field.name, BytesOf(field.values), BytesOf(field.all_values)});
    }
  }
  bytes.series = BytesOf(frame.series);
  bytes.poses = BytesOf(frame.poses);
  for (const LineFrame& line : frame.lines) bytes.lines.push_back({BytesOf(line.points), BytesOf(line.values)});
  return DigestOf(bytes);
}

}  // namespace fascicle
