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
  std::optional<std::size_t> lines;  // how many there must be; not known without a mesh
  std::size_t columns;               // numbers on a line
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

// Its numbers, line by line. Empty where something is wrong, or the mesh is not known: every bad line is named.
std::vector<double> ReadNumberFile(const v1::FileRef& file, const NumberFile& expected, const std::string& path,
                                   const AssetReader& assets, Problems& problems);

// Adds a problem where a file has another number of lines than the mesh has `item`.
void CheckLineCount(std::size_t lines, std::size_t expected, const char* item, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_NUMBER_FILES_H_
