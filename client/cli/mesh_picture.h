#ifndef FASCICLE_CLIENT_CLI_MESH_PICTURE_H_
#define FASCICLE_CLIENT_CLI_MESH_PICTURE_H_

#include <filesystem>
#include <string>
#include <vector>

#include "core/geometry/region.h"

namespace fascicle::client {

// Draws a mesh with its edges, each region in its own colour. `unit` is the unit of its lengths [m]. Throws
// std::runtime_error with a message for users.
void DrawMesh(const TetMesh& mesh, const std::vector<Region>& regions, double unit, const std::string& title,
              const std::filesystem::path& path);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_MESH_PICTURE_H_
