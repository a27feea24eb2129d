#include "core/base/frame_digest.h"

#include <algorithm>
#include <bit>

namespace fascicle {
namespace {

static_assert(std::endian::native == std::endian::little, "digests are over little-endian bytes");

template <class Value>
void Add(Sha256& sha, const Value& value) {
  sha.Update(std::as_bytes(std::span(&value, 1)));
}

void AddText(Sha256& sha, std::string_view text) {
  Add(sha, static_cast<std::uint64_t>(text.size()));
  sha.Update(text);
}

void AddArray(Sha256& sha, FrameBytes::Bytes items, std::size_t item_size) {
  Add(sha, static_cast<std::uint64_t>(items.size() / item_size));
  sha.Update(items);
}

constexpr std::size_t kNumber = sizeof(double), kPoint = 3 * kNumber, kPose = 7 * kNumber;

// Positions and fields at the higher-order nodes of each body, if any body has some.
void AddHigherOrder(Sha256& sha, const FrameBytes& frame) {
  if (std::all_of(frame.bodies.begin(), frame.bodies.end(),
                  [](const FrameBytes::Body& body) { return body.higher_order_positions.empty(); })) {
    return;
  }
  AddText(sha, "higher_order");
  for (const FrameBytes::Body& body : frame.bodies) {
    AddArray(sha, body.higher_order_positions, kPoint);
    for (const FrameBytes::Field& field : body.fields) AddArray(sha, field.all_values, kNumber);
  }
}

}  // namespace

Digest DigestOf(const FrameBytes& frame) {
  Sha256 sha;
  Add(sha, frame.index);
  Add(sha, frame.time);
  Add(sha, frame.step);
  Add(sha, static_cast<std::uint64_t>(frame.bodies.size()));
  for (const FrameBytes::Body& body : frame.bodies) {
    AddArray(sha, body.positions, kPoint);
    Add(sha, static_cast<std::uint64_t>(body.fields.size()));
    for (const FrameBytes::Field& field : body.fields) {
      AddText(sha, field.name);
      AddArray(sha, field.values, kNumber);
    }
  }
  AddArray(sha, frame.series, kNumber);
  if (!frame.poses.empty()) {
    AddText(sha, "poses");
    AddArray(sha, frame.poses, kPose);
  }
  if (!frame.lines.empty()) {
    AddText(sha, "lines");
    Add(sha, static_cast<std::uint64_t>(frame.lines.size()));
    for (const FrameBytes::Line& line : frame.lines) {
      AddArray(sha, line.points, kPoint);
      AddArray(sha, line.values, kNumber);
    }
  }
  AddHigherOrder(sha, frame);
  return sha.Finish();
}

}  // namespace fascicle
