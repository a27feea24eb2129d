#ifndef FASCICLE_SERVER_TRANSLATE_MESHES_H_
#define FASCICLE_SERVER_TRANSLATE_MESHES_H_

#include <optional>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/geometry/brick_mesh.h"
#include "core/geometry/tet_mesh.h"
#include "core/geometry/triangle_mesh.h"
#include "core/scene/method.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/body_source.h"

namespace fascicle::server {

// The path of the source of a body's mesh, such as `bodies[0].mesh.box`.
std::string SourcePath(const v1::Mesh& mesh, const std::string& body_path);

// The mesh of a body in metres, one function for each kind. Nothing if there is no mesh for further checks. Elements
// are deducted from the source's budget.

struct TranslatedTetrahedra {
  TetMesh mesh;       // indices in range and coordinates finite
  bool sound = true;  // whether CheckMesh found no problem
  // Of a file of second order: MeshRemarks::node_places.
  std::vector<std::array<std::int32_t, 2>> node_places = {};
};

// From a mesh file or a built-in shape. `method` is for messages. Adds to `notes` what was left out of the file.
std::optional<TranslatedTetrahedra> TranslateTetrahedra(const BodySource& source, Method method,
                                                        std::vector<std::string>& notes, Problems& problems);

// The voxels of an image or a box. Adds results of the image's stages to `notes`.
std::optional<BrickMesh> TranslateBricks(const BodySource& source, std::vector<std::string>& notes, Problems& problems);

// The triangles of the mesh's surface file. Adds to `notes` flaws in spite of which it was read.
std::optional<TriangleMesh> TranslateSurfaceFile(const BodySource& source, std::vector<std::string>& notes,
                                                 Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_MESHES_H_
