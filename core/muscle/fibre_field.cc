#include "core/muscle/fibre_field.h"

#include <string>

#include "core/base/text_lines.h"

namespace fascicle {
FibreField ConstantFibres(const TetMesh& mesh, const Vec3& direction) {
  return FibreField(mesh.tetrahedra.size(), direction.stableNormalized());
}

FibreField ReadFibres(const TetMesh& mesh, std::string_view text, Problems& problems) {
  const std::size_t expected = mesh.tetrahedra.size();
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
    problems.Add({}, std::to_string(vectors) + " fibre directions for " + std::to_string(expected) + " tetrahedra",
                 "give one line for each tetrahedron, in the order of the mesh file");
    sound = false;
  }
  return sound ? fibres : FibreField();
}

}  // namespace fascicle
