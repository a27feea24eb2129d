// STL, ASCII and binary [3D Systems, "StereoLithography Interface Specification", 1989].
#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <utility>

#include "core/base/stop.h"
#include "core/geometry/byte_array.h"
#include "core/geometry/surface_readers.h"
#include "core/geometry/text_scanner.h"

namespace fascicle {
namespace {

constexpr std::size_t kHeader = 80, kFacet = 50;

// Makes a triangle of every three corners. Corners at the same position become one node, numbered by first appearance.
RawSurface Join(const std::vector<Vec3>& corners, const std::stop_token& stop) {
  std::vector<std::size_t> order(corners.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto less = [&](std::size_t a, std::size_t b) {
    const Vec3 &p = corners[a], &q = corners[b];
    for (int axis = 0; axis < 3; ++axis) {
      if (p[axis] != q[axis]) return p[axis] < q[axis];
    }
    return a < b;
  };
  SortUnlessStopped(order, stop, less);
  std::vector<std::size_t> first(corners.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && corners[order[i]] == corners[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  RawSurface raw;
  std::vector<std::int64_t> number(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (first[i] == i) {
      number[i] = static_cast<std::int64_t>(raw.nodes.size());
      raw.nodes.push_back(corners[i]);
    }
    if (i % 3 == 2) raw.polygons.push_back({number[first[i - 2]], number[first[i - 1]], number[first[i]]});
  }
  return raw;
}

std::vector<Vec3> ReadBinary(std::string_view bytes, std::size_t count, const std::stop_token& stop) {
  std::vector<Vec3> corners;
  corners.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    ThrowIfStopped(stop);
    // A normal, which is not used, and three corners.
    const std::string_view numbers = bytes.substr(kHeader + 4 + kFacet * i + 12, 36);
    const std::vector<double> values = ToDoubles(numbers, NumberType::kFloat32, false);
    for (int corner = 0; corner < 3; ++corner) corners.emplace_back(values.data() + 3 * corner);
  }
  return corners;
}

std::vector<Vec3> ReadAscii(std::string_view bytes, const std::stop_token& stop, Problems& problems) {
  std::vector<Vec3> corners;
  TextScanner in(bytes, problems, '\0', stop);
  while (!in.failed() && !in.AtEnd()) {
    in.Expect("solid");
    in.Line();
    while (!in.failed() && in.Peek() == "facet") {
      in.Token();
      in.Expect("normal");
      // The normal. Some programs write nan here; it is not used.
      for (int i = 0; i < 3; ++i) in.Token();
      in.Expect("outer");
      in.Expect("loop");
      for (int corner = 0; corner < 3; ++corner) {
        in.Expect("vertex");
        const double x = in.Double("a coordinate"), y = in.Double("a coordinate"), z = in.Double("a coordinate");
        corners.emplace_back(x, y, z);
      }
      in.Expect("endloop");
      in.Expect("endfacet");
    }
    in.Expect("endsolid");
    in.Line();
  }
  return corners;
}

}  // namespace

RawSurface ReadStl(std::string_view bytes, const std::stop_token& stop, Problems& problems) {
  // Binary files may begin with `solid`, too; their size identifies them.
  std::uint32_t count = 0;
  if (bytes.size() >= kHeader + 4) std::memcpy(&count, bytes.data() + kHeader, 4);
  const bool binary = bytes.size() >= kHeader + 4 && bytes.size() == kHeader + 4 + kFacet * std::size_t{count};
  if (binary) return Join(ReadBinary(bytes, count, stop), stop);
  TextScanner start(bytes, problems);
  if (start.Peek() == "solid") return Join(ReadAscii(bytes, stop, problems), stop);
  if (bytes.size() < kHeader + 4) {
    problems.Add("", "the file is too short for STL", "is the file complete?");
  } else {
    problems.Add("",
                 "the file announces " + std::to_string(count) + " triangles, which take " +
                     std::to_string(kHeader + 4 + kFacet * std::size_t{count}) + " bytes, but has " +
                     std::to_string(bytes.size()),
                 "is the file complete, and is it STL?");
  }
  return {};
}

}  // namespace fascicle
