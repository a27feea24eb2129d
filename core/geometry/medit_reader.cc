// MEDIT .mesh, ASCII [Frey 2001, "MEDIT: an interactive mesh visualization software", INRIA RT-0253].
#include <string>

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
  bool has_vertices = false, has_tetrahedra = false, has_triangles = false, ended = false;
  while (!in.failed() && !ended && !in.AtEnd()) {
    const std::string_view keyword = in.Token();
    if (keyword == "Dimension") {
      const std::int64_t dimension = in.Int("the dimension");
      if (!in.failed() && dimension != 3) {
        in.Fail("the mesh has dimension " + std::to_string(dimension), "a mesh of a body has dimension 3");
      }
    } else if (keyword == "Vertices" && !has_vertices) {
      has_vertices = true;
      ReadVertices(in, raw);
    } else if (keyword == "Tetrahedra" && !has_tetrahedra) {
      has_tetrahedra = true;
      ReadCells(in, "tetrahedra", raw.tetrahedra, raw.tetrahedron_tags);
    } else if (keyword == "Triangles" && !has_triangles) {
      has_triangles = true;
      ReadCells(in, "triangles", raw.triangles, raw.triangle_tags);
    } else if (keyword == "Vertices" || keyword == "Tetrahedra" || keyword == "Triangles") {
      in.Fail("a second section " + std::string(keyword));
    } else if (keyword == "End") {
      ended = true;
    } else if (IsKeyword(keyword)) {
      SkipNumbers(in);
    } else {
      in.Fail("expected a keyword such as Tetrahedra but found " + Quoted(keyword));
    }
  }
  if (!in.failed() && !ended) in.Fail("the file ends without the keyword End", "is the file complete?");
  return raw;
}

}  // namespace fascicle
