#include "core/muscle/fibre_field.h"

#include <string>

#include "core/base/text_lines.h"
#include "core/geometry/hexahedron.h"

namespace fascicle {
FibreField ConstantFibres(const TetMesh& mesh, const Vec3& direction) {
  return FibreField(ElementCount(mesh), direction.stableNormalized());
}

FibreField ReadFibres(const TetMesh& mesh, std::string_view text, Problems& problems) {
  const std::size_t expected = ElementCount(mesh);
  const std::string kind = mesh.hexahedra.empty() ? "tetrahedr" : "hexahedr";
  FibreField fibres;
  fibres.reserve(expected);
  std::size_t vectors = 0;
  bool sound = true;
  const auto complain = [&](std::size_t line, const char* what) {
    problems.Add({}, "line " + std::to_string(line) + ": " + what);
    sound = false;
  };
  for (TextLines lines(text); lines.Next();) {
    ++vectors;
    Vec3 vector;
    if (!ParseNumbers(lines.line(), {vector.data(), 3})) {
      complain(lines.number(), "not three finite numbers with blanks between them");
    } else if (vector.isZero(0)) {
      complain(lines.number(), "a fibre direction of zero length");
    } else if (fibres.size() < expected) {
      fibres.push_back(vector.stableNormalized());
    }
  }
  if (vectors != expected) {
    problems.Add({}, std::to_string(vectors) + " fibre directions for " + std::to_string(expected) + " " + kind + "a",
                 "give one line for each " + kind + "on, in the order of the mesh file");
    sound = false;
  }
  return sound ? fibres : FibreField();
}

FibreField OfElements(const TetMesh& mesh, FibreField of_tetrahedra) {
  if (mesh.hexahedra.empty() || of_tetrahedra.empty()) return of_tetrahedra;
  FibreField fibres;
  fibres.reserve(mesh.hexahedra.size());
  const std::vector<std::size_t> first = FirstTetrahedra(mesh);
  for (std::size_t h = 0; h < mesh.hexahedra.size(); ++h) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t t = first[h]; t < first[h + 1]; ++t) sum += SignedVolume(mesh, t) * of_tetrahedra[t];
    fibres.push_back(sum.isZero(0) ? of_tetrahedra[first[h]] : Vec3(sum.stableNormalized()));
  }
  return fibres;
}

}  // namespace fascicle
