#ifndef FASCICLE_SERVER_TRANSLATE_MESHES_H_
#define FASCICLE_SERVER_TRANSLATE_MESHES_H_

#include <optional>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/brick_mesh.h"
#include "core/geometry/tet_mesh.h"
#include "core/geometry/triangle_mesh.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/body_source.h"

namespace fascicle::server {

// The path of the source that a body's mesh names, such as `bodies[0].mesh.box`.
std::string SourcePath(const v1::Mesh& mesh, const std::string& body_path);

// The mesh of a body in metres, one function for each kind. Nothing when there is no mesh that other checks could look
// at. What it has of elements is taken from the source's budget.

struct TranslatedTetrahedra {
  TetMesh mesh;       // indices in range and coordinates finite
  bool sound = true;  // CheckMesh found nothing
};

// Of a mesh file or a built-in shape. `method`: its name, for messages.
std::optional<TranslatedTetrahedra> TranslateTetrahedra(const BodySource& source, const char* method,
                                                        Problems& problems);

// The voxels of an image or a box. Adds to `notes` what came out of an image.
std::optional<BrickMesh> TranslateBricks(const BodySource& source, std::vector<std::string>& notes, Problems& problems);

// The triangles of a surface file, which the mesh names.
std::optional<TriangleMesh> TranslateSurfaceFile(const BodySource& source, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_MESHES_H_
