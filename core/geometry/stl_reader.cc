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

// Keywords are taken in any case.
std::vector<Vec3> ReadAscii(std::string_view bytes, const std::stop_token& stop, std::vector<std::string>& notes,
                            Problems& problems) {
  std::vector<Vec3> corners;
  TextScanner in(bytes, problems, '\0', stop);
  while (!in.failed() && !in.AtEnd()) {
    in.ExpectInAnyCase("solid");
    in.Line();
    while (!in.failed() && SameInAnyCase(in.Peek(), "facet")) {
      in.Token();
      in.ExpectInAnyCase("normal");
      // The normal. Some programs write nan here; it is not used.
      for (int i = 0; i < 3; ++i) in.Token();
      in.ExpectInAnyCase("outer");
      in.ExpectInAnyCase("loop");
      for (int corner = 0; corner < 3; ++corner) {
        in.ExpectInAnyCase("vertex");
        const double x = in.Double("a coordinate"), y = in.Double("a coordinate"), z = in.Double("a coordinate");
        corners.emplace_back(x, y, z);
      }
      in.ExpectInAnyCase("endloop");
      in.ExpectInAnyCase("endfacet");
    }
    if (!in.failed() && !corners.empty() && in.AtEnd()) {
      notes.push_back("the file ends without `endsolid`, after " + std::to_string(corners.size() / 3) + " triangles");
      break;
    }
    in.ExpectInAnyCase("endsolid");
    in.Line();
  }
  return corners;
}

// Whether the bytes are text that begins with `solid`. Binary files may begin so, too, but have zeros in their header
// or in their first numbers.
bool IsAscii(std::string_view bytes) {
  constexpr std::size_t kLookedAt = 512;
  Problems ignored;
  TextScanner start(WithoutByteOrderMark(bytes), ignored);
  return SameInAnyCase(start.Peek(), "solid") && bytes.substr(0, kLookedAt).find('\0') == std::string_view::npos;
}

// The number of triangles of a binary file. Files that were cut are problems; a tail, or a count that was never filled
// in, is noted.
std::size_t CountTriangles(std::string_view bytes, std::vector<std::string>& notes, Problems& problems) {
  if (bytes.size() < kHeader + 4) {
    problems.Add("", "the file is too short for STL", "is the file complete?");
    return 0;
  }
  std::uint32_t announced = 0;
  std::memcpy(&announced, bytes.data() + kHeader, 4);
  const std::size_t wanted = kHeader + 4 + kFacet * std::size_t{announced}, room = bytes.size() - kHeader - 4;
  if (announced == 0 && room > 0 && room % kFacet == 0) {
    notes.push_back("the file announces no triangles but has " + std::to_string(room / kFacet) + ": they are read");
    return room / kFacet;
  }
  if (announced == 0 || bytes.size() < wanted) {
    problems.Add("",
                 "the file announces " + std::to_string(announced) + " triangles, which take " +
                     std::to_string(wanted) + " bytes, but has " + std::to_string(bytes.size()),
                 "is the file complete, and is it STL?");
    return 0;
  }
  if (bytes.size() > wanted) {
    notes.push_back("the last " + std::to_string(bytes.size() - wanted) + " bytes of the file, after its " +
                    std::to_string(announced) + " triangles, are left out");
  }
  return announced;
}

}  // namespace

RawSurface ReadStl(std::string_view bytes, const std::stop_token& stop, Problems& problems) {
  std::vector<std::string> notes;
  // The size identifies binary files that begin with `solid`.
  std::uint32_t announced = 0;
  if (bytes.size() >= kHeader + 4) std::memcpy(&announced, bytes.data() + kHeader, 4);
  const bool exact = bytes.size() >= kHeader + 4 && bytes.size() == kHeader + 4 + kFacet * std::size_t{announced};
  std::vector<Vec3> corners;
  if (!exact && IsAscii(bytes)) {
    corners = ReadAscii(WithoutByteOrderMark(bytes), stop, notes, problems);
  } else {
    corners = ReadBinary(bytes, CountTriangles(bytes, notes, problems), stop);
  }
  RawSurface raw = Join(corners, stop);
  raw.notes = std::move(notes);
  return raw;
}

}  // namespace fascicle
