#ifndef FASCICLE_SERVER_TRANSLATE_BUILT_IN_SHAPES_H_
#define FASCICLE_SERVER_TRANSLATE_BUILT_IN_SHAPES_H_

#include <cstdint>
#include <optional>
#include <string>

#include "core/base/problems.h"
#include "core/geometry/shapes.h"
#include "fascicle/v1/scene.pb.h"

namespace fascicle::server {

struct ShapeSize {
  std::string path;             // of the shape
  std::int64_t tetrahedra = 0;  // number of tetrahedra that MakeShape would make
};

// Checks the parameters of a built-in shape (defaults filled in) against each other, without building it. Nothing if it
// can't be built or if there is none.
std::optional<ShapeSize> CheckShape(const v1::Mesh& mesh, const std::string& path, Problems& problems);

// Builds a shape that CheckShape has accepted; `metres` is its length unit.
TetMesh MakeShape(const v1::Mesh& mesh, double metres, Cells cells);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_BUILT_IN_SHAPES_H_
