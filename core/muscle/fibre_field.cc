#include "core/muscle/fibre_field.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string>

namespace fascicle {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::string_view Trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

// Takes the first line off `text`, without its comment and the blanks around it.
std::string_view TakeLine(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  return Trimmed(line.substr(0, line.find('#')));
}

// Exactly three finite numbers with blanks between them.
std::optional<Vec3> ParseVector(std::string_view line) {
  Vec3 vector;
  for (int i = 0; i < 3; ++i) {
    const std::string_view number = line.substr(0, line.find_first_of(kBlanks));
    const char* begin = number.data() + (number.starts_with('+') && !number.starts_with("+-") ? 1 : 0);
    const char* end = number.data() + number.size();
    const auto [stop, error] = std::from_chars(begin, end, vector[i]);
    if (error != std::errc() || stop != end || !std::isfinite(vector[i])) return std::nullopt;
    line = Trimmed(line.substr(number.size()));
  }
  if (!line.empty()) return std::nullopt;
  return vector;
}

}  // namespace

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
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = TakeLine(text);
    if (line.empty()) continue;
    ++vectors;
    if (const std::optional<Vec3> vector = ParseVector(line); !vector) {
      complain(number, "not three finite numbers with blanks between them");
    } else if (vector->isZero(0)) {
      complain(number, "a fibre direction of zero length");
    } else if (fibres.size() < expected) {
      fibres.push_back(vector->stableNormalized());
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
