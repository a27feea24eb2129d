#include "core/sim/frame.h"

#include <bit>
#include <span>
#include <utility>

namespace fascicle {
namespace {

static_assert(std::endian::native == std::endian::little, "digests are over little-endian bytes");

template <class Value>
void Add(Sha256& sha, const Value& value) {
  sha.Update(std::as_bytes(std::span(&value, 1)));
}

// Length first, so that no two different frames give the same bytes.
template <class Item>
void AddArray(Sha256& sha, const std::vector<Item>& items) {
  Add(sha, static_cast<std::uint64_t>(items.size()));
  sha.Update(std::as_bytes(std::span(items)));
}

}  // namespace

FieldValues FieldOf(OutputField field, Method method, std::vector<double> values) {
  const OutputFieldInfo& info = InfoOf(field);
  return {info.name, LocationOf(info, method), static_cast<int>(info.components), info.unit, std::move(values)};
}

Digest DigestOf(const Frame& frame) {
  Sha256 sha;
  Add(sha, frame.index);
  Add(sha, frame.time);
  Add(sha, frame.step);
  Add(sha, static_cast<std::uint64_t>(frame.bodies.size()));
  for (const BodyFrame& body : frame.bodies) {
    AddArray(sha, body.positions);
    Add(sha, static_cast<std::uint64_t>(body.fields.size()));
    for (const FieldValues& field : body.fields) {
      Add(sha, static_cast<std::uint64_t>(field.name.size()));
      sha.Update(field.name);
      AddArray(sha, field.values);
    }
  }
  AddArray(sha, frame.series);
  return sha.Finish();
}

}  // namespace fascicle
