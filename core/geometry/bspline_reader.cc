#include "core/geometry/bspline_reader.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/text_scanner.h"

namespace fascicle {
namespace {

constexpr std::array<std::string_view, 3> kDirections = {"u", "v", "w"};
constexpr std::size_t kBytesPerPoint = 6;  // "0 0 0\n"

struct Head {
  std::array<std::int64_t, 3> degrees{}, sizes{};
  std::array<std::vector<double>, 3> knots;
};

// Fails with the first problem that a basis has found.
void FailWith(const Problems& found, std::string_view direction, TextScanner& in) {
  if (found.empty()) return;
  const Problem& problem = found.kept().front();
  in.Fail(std::string(direction) + ": " + problem.message, problem.hint);
}

// Reads degrees and numbers of control points. They must match each other, and the rest of the text must be able to
// hold so many points.
Head ReadHead(TextScanner& in) {
  Head head;
  in.Expect("bspline_solid");
  in.Expect("degrees");
  for (std::int64_t& degree : head.degrees) degree = in.Int("a degree");
  in.Expect("controls");
  for (std::int64_t& size : head.sizes) size = in.Int("a number of control points");
  std::int64_t points = 1;
  for (std::size_t d = 0; d < 3 && in.Holds(head.sizes[d], "control points", kBytesPerPoint); ++d) {
    Problems found;
    BsplineBasis::CheckSize(head.degrees[d], head.sizes[d], found);
    FailWith(found, kDirections[d], in);
    points *= head.sizes[d];
    if (!in.Holds(points, "control points", kBytesPerPoint)) break;
  }
  return head;
}

void ReadKnots(TextScanner& in, Head& head) {
  const std::string_view name = in.Token();
  const auto direction = std::find(kDirections.begin(), kDirections.end(), name);
  if (direction == kDirections.end()) return in.Fail("knots of " + Quoted(name), "give u, v or w");
  const auto d = static_cast<std::size_t>(direction - kDirections.begin());
  std::vector<double> knots;
  for (std::int64_t i = 0; i < head.sizes[d] + head.degrees[d] + 1 && !in.failed(); ++i) {
    knots.push_back(in.Double("a knot"));
  }
  if (in.failed()) return;
  Problems found;
  BsplineBasis::CheckKnots(static_cast<int>(head.degrees[d]), knots, found);
  FailWith(found, name, in);
  head.knots[d] = std::move(knots);
}

std::vector<Vec3> ReadPoints(TextScanner& in, std::int64_t count) {
  std::vector<Vec3> points;
  if (!in.Holds(count, "control points", kBytesPerPoint)) return points;
  points.reserve(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count && !in.failed(); ++i) {
    const double x = in.Double("a coordinate"), y = in.Double("a coordinate"), z = in.Double("a coordinate");
    points.emplace_back(x, y, z);
    if (!points.back().allFinite()) in.Fail("a control point is not finite");
  }
  if (!in.failed() && !in.AtEnd()) in.Fail("more follows than " + std::to_string(count) + " control points");
  return points;
}

BsplineBasis MakeBasis(const Head& head, std::size_t d) {
  const int degree = static_cast<int>(head.degrees[d]);
  return head.knots[d].empty() ? BsplineBasis::Uniform(degree, static_cast<int>(head.sizes[d]))
                               : BsplineBasis(degree, head.knots[d]);
}

}  // namespace

std::optional<BsplineSolid> ReadBsplineSolid(std::string_view text, Problems& problems) {
  TextScanner in(text, problems, '#');
  Head head = ReadHead(in);
  while (in.Peek() == "knots") {
    in.Token();
    ReadKnots(in, head);
  }
  in.Expect("points");
  if (in.failed()) return std::nullopt;
  std::vector<Vec3> points = ReadPoints(in, head.sizes[0] * head.sizes[1] * head.sizes[2]);
  if (in.failed()) return std::nullopt;
  return BsplineSolid({MakeBasis(head, 0), MakeBasis(head, 1), MakeBasis(head, 2)}, std::move(points));
}

}  // namespace fascicle
