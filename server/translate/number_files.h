#ifndef FASCICLE_SERVER_TRANSLATE_NUMBER_FILES_H_
#define FASCICLE_SERVER_TRANSLATE_NUMBER_FILES_H_

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/translate.h"

namespace fascicle::server {

// A text file with a line of numbers for each tetrahedron or node, in the order of the mesh; `#` starts a comment.
struct NumberFile {
  const char* item;                  // "tetrahedra", "nodes": what has a line
  std::optional<std::size_t> lines;  // required number of lines; unknown without a mesh
  std::size_t columns;               // numbers per line
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  // Another number of lines that is allowed, and what the file then has a line for.
  std::size_t or_lines = 0;
  const char* or_item = nullptr;
};

// The numbers, line by line. Empty if something is wrong, or if the mesh is unknown; every bad line is reported.
std::vector<double> ReadNumberFile(const v1::FileRef& file, const NumberFile& expected, const std::string& path,
                                   const AssetReader& assets, Problems& problems);

// Adds a problem if a file's number of lines differs from the mesh's number of `item`.
void CheckLineCount(std::size_t lines, std::size_t expected, const char* item, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_NUMBER_FILES_H_
