// MEDIT .mesh, ASCII [Frey 2001, "MEDIT: an interactive mesh visualization software", INRIA RT-0253].
#include <set>
#include <string>
#include <string_view>

#include "core/geometry/mesh_readers.h"
#include "core/geometry/text_scanner.h"

namespace fascicle {
namespace {

void ReadVertices(TextScanner& in, RawMesh& raw) {
  const std::size_t count = in.Count("vertices", 8);
  raw.nodes.reserve(count);
  for (std::size_t i = 0; i < count && !in.failed(); ++i) {
    const double x = in.Double("a coordinate"), y = in.Double("a coordinate"), z = in.Double("a coordinate");
    in.Double("a reference");  // some programs write it as 0.0
    raw.nodes.emplace_back(x, y, z);
  }
}

template <std::size_t N>
void ReadCells(TextScanner& in, std::string_view what, std::vector<std::array<std::int64_t, N>>& cells,
               std::vector<std::int64_t>& tags) {
  const std::size_t count = in.Count(what, 2 * (N + 1));
  cells.reserve(count);
  tags.reserve(count);
  for (std::size_t i = 0; i < count && !in.failed(); ++i) {
    for (std::int64_t& node : cells.emplace_back()) node = in.Int("a node number");
    tags.push_back(in.Int("a reference"));
  }
}

void ReadSolids(TextScanner& in, std::string_view what, SolidShape shape, RawMesh& raw) {
  const int corners = CornersOf(shape);
  const std::size_t count = in.Count(what, static_cast<std::size_t>(2 * (corners + 1)));
  for (std::size_t i = 0; i < count && !in.failed(); ++i) {
    RawSolid& solid = raw.solids.emplace_back(RawSolid{shape, {}});
    for (int n = 0; n < corners; ++n) solid.nodes[n] = in.Int("a node number");
    raw.solid_tags.push_back(in.Int("a reference"));
  }
}

// Reads a section of cells; false if the keyword names none.
bool ReadSection(TextScanner& in, std::string_view keyword, RawMesh& raw) {
  if (keyword == "Vertices") {
    ReadVertices(in, raw);
  } else if (keyword == "Tetrahedra") {
    ReadCells(in, "tetrahedra", raw.tetrahedra, raw.tetrahedron_tags);
  } else if (keyword == "Triangles") {
    ReadCells(in, "triangles", raw.triangles, raw.triangle_tags);
  } else if (keyword == "Quadrilaterals") {
    ReadCells(in, "quadrilaterals", raw.quads, raw.quad_tags);
  } else if (keyword == "Hexahedra") {
    ReadSolids(in, "hexahedra", SolidShape::kHexahedron, raw);
  } else if (keyword == "Prisms") {
    ReadSolids(in, "prisms", SolidShape::kWedge, raw);
  } else if (keyword == "Pyramids") {
    ReadSolids(in, "pyramids", SolidShape::kPyramid, raw);
  } else {
    return false;
  }
  return true;
}

const std::set<std::string_view> kCells = {"Vertices",  "Tetrahedra", "Triangles", "Quadrilaterals",
                                           "Hexahedra", "Prisms",     "Pyramids"};

bool IsKeyword(std::string_view token) {
  const char c = token.empty() ? '\0' : token.front();
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

// Skips the numbers of a section that is not read.
void SkipNumbers(TextScanner& in) {
  while (!in.AtEnd() && !IsKeyword(in.Peek())) in.Token();
}

}  // namespace

RawMesh ReadMedit(std::string_view bytes, const std::stop_token& stop, Problems& problems) {
  RawMesh raw;
  raw.first_node = 1;
  TextScanner in(bytes, problems, '#', stop);
  in.Expect("MeshVersionFormatted");
  in.Int("the format's version");
  std::set<std::string_view> sections;
  bool ended = false;
  while (!in.failed() && !ended && !in.AtEnd()) {
    const std::string_view keyword = in.Token();
    if (keyword == "Dimension") {
      const std::int64_t dimension = in.Int("the dimension");
      if (!in.failed() && dimension != 3) {
        in.Fail("the mesh has dimension " + std::to_string(dimension), "a mesh of a body has dimension 3");
      }
    } else if (keyword == "End") {
      ended = true;
    } else if (!IsKeyword(keyword)) {
      in.Fail("expected a keyword such as Tetrahedra but found " + Quoted(keyword));
    } else if (!sections.insert(keyword).second && kCells.contains(keyword)) {
      in.Fail("a second section " + std::string(keyword));
    } else if (!ReadSection(in, keyword, raw)) {
      SkipNumbers(in);
    }
  }
  // Some programs leave out the last keyword. All sections announce their lengths, so only the last number may be cut.
  const bool whole_line = bytes.ends_with('\n') || bytes.ends_with('\r');
  if (!in.failed() && !ended && !whole_line) {
    in.Fail("the file ends without the keyword End, within a line", "is the file complete?");
  }
  return raw;
}

}  // namespace fascicle
