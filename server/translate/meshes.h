#ifndef FASCICLE_SERVER_TRANSLATE_MESHES_H_
#define FASCICLE_SERVER_TRANSLATE_MESHES_H_

#include <cstdint>
#include <optional>
#include <string>

#include "core/base/problems.h"
#include "core/geometry/brick_mesh.h"
#include "core/geometry/tet_mesh.h"
#include "core/scene/scene.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/translate.h"

namespace fascicle::server {

struct TranslatedMesh {
  TetMesh mesh;          // [m]; indices in range and coordinates finite
  BrickMesh bricks;      // of the voxel method, instead [m]
  TriangleMesh surface;  // of the eulerian method, with the tetrahedra that it is the boundary of, or without [m]
  bool sound = true;     // CheckMesh found nothing

  std::size_t elements() const { return mesh.tetrahedra.size() + bricks.bricks.size(); }
  const std::vector<Vec3>& nodes() const {
    if (mesh.nodes.empty() && bricks.nodes.empty()) return surface.nodes;
    return mesh.nodes.empty() ? bricks.nodes : mesh.nodes;
  }
};

// The path of the source that a body's mesh names, such as `bodies[0].mesh.box`.
std::string SourcePath(const v1::Mesh& mesh, const std::string& body_path);

// The mesh of a body (defaults filled in) in metres: tetrahedra, or voxels for the voxel method, or a surface for the
// eulerian one. `budget` is the number of elements that are left for it, and is reduced by those it has. Nothing when
// there is no mesh that other checks could look at. Adds to `notes` what is noteworthy.
std::optional<TranslatedMesh> TranslateMesh(const v1::Body& body, Method method, const std::string& body_path,
                                            const AssetReader& assets, std::int64_t& budget,
                                            std::vector<std::string>& notes, Problems& problems);

// Bytes of the file that `file` names; nothing, with a problem, when its digest is malformed or its asset is not there.
std::optional<std::string> ReadFile(const v1::FileRef& file, const std::string& path, const AssetReader& assets,
                                    Problems& problems);

// The 64 hexadecimal digits of `assets/{sha256}`; empty when it is not of this form.
std::string DigestOfAsset(const std::string& asset);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_MESHES_H_
