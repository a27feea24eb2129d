// TetGen .node and .ele [Si 2015, TetGen manual, 5.2].
#include <cmath>
#include <string>
#include <vector>

#include "core/geometry/mesh_readers.h"
#include "core/geometry/text_scanner.h"

namespace fascicle {
namespace {

// Number of values that follow on each line. A file cannot hold more of them than it has bytes.
std::int64_t Width(TextScanner& in, std::string_view what) {
  const std::int64_t width = in.Int(what);
  if (!in.failed() && (width < 0 || width > 1000)) in.Fail(std::to_string(width) + " as " + std::string(what));
  return in.failed() ? 0 : width;
}

void ReadNodes(TextScanner& in, RawMesh& raw) {
  const std::size_t count = in.Count("nodes", 8);
  const std::int64_t dimension = in.Int("the dimension");
  if (!in.failed() && dimension != 3) in.Fail("the nodes have dimension " + std::to_string(dimension));
  const std::int64_t extras = Width(in, "the number of attributes") + Width(in, "the number of boundary markers");
  raw.nodes.reserve(count);
  raw.node_numbers.reserve(count);
  for (std::size_t i = 0; i < count && !in.failed(); ++i) {
    raw.node_numbers.push_back(in.Int("a node number"));
    const double x = in.Double("a coordinate"), y = in.Double("a coordinate"), z = in.Double("a coordinate");
    raw.nodes.emplace_back(x, y, z);
    for (std::int64_t e = 0; e < extras; ++e) in.Double("an attribute");
  }
  if (!in.failed() && count > 0 && raw.node_numbers[0] != 0 && raw.node_numbers[0] != 1) {
    in.Fail("the first node has number " + std::to_string(raw.node_numbers[0]), "TetGen counts from 0 or from 1");
  }
}

void ReadElements(TextScanner& in, RawMesh& raw) {
  const std::size_t count = in.Count("tetrahedra", 8);
  const std::int64_t corners = in.Int("the number of nodes of a tetrahedron");
  const std::int64_t attributes = Width(in, "the number of attributes");
  if (in.failed()) return;
  if (corners == 10) {
    raw.higher_order = count;
    return;
  }
  if (corners != 4) return in.Fail("tetrahedra of " + std::to_string(corners) + " nodes");
  raw.tetrahedra.reserve(count);
  raw.tetrahedron_tags.reserve(count);
  for (std::size_t i = 0; i < count && !in.failed(); ++i) {
    in.Int("the number of a tetrahedron");
    for (std::int64_t& node : raw.tetrahedra.emplace_back()) node = in.Int("a node number");
    double region = 0;
    for (std::int64_t a = 0; a < attributes; ++a) {
      const double attribute = in.Double("an attribute");
      if (a == 0) region = attribute;
    }
    if (!(std::abs(region) < 1e15) || region != std::floor(region)) {
      return in.Fail("the region attribute is not a whole number", "give regions whole numbers");
    }
    raw.tetrahedron_tags.push_back(static_cast<std::int64_t>(region));
  }
}

void ExpectEnd(TextScanner& in) {
  if (!in.failed() && !in.AtEnd()) in.Fail("more values than announced: " + Quoted(in.Peek()));
}

}  // namespace

RawMesh ReadTetgen(std::string_view node_bytes, std::string_view element_bytes, const std::stop_token& stop,
                   Problems& problems) {
  RawMesh raw;
  TextScanner nodes(node_bytes, problems, '#', stop);
  ReadNodes(nodes, raw);
  ExpectEnd(nodes);
  if (nodes.failed()) return raw;
  if (element_bytes.empty()) {
    problems.Add("", "the .ele file with the tetrahedra is missing",
                 "put it beside the .node file, or name it in `elements`");
    return raw;
  }
  Problems in_elements;
  TextScanner elements(element_bytes, in_elements, '#', stop);
  ReadElements(elements, raw);
  if (raw.higher_order == 0) ExpectEnd(elements);
  for (const Problem& problem : in_elements.kept()) problems.Add("", ".ele file, " + problem.message, problem.hint);
  return raw;
}

}  // namespace fascicle
