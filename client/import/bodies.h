#ifndef FASCICLE_CLIENT_IMPORT_BODIES_H_
#define FASCICLE_CLIENT_IMPORT_BODIES_H_

#include <array>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "client/import/model.h"
#include "client/import/tetrahedra.h"

namespace fascicle::client {

// Face-connected tetrahedra, with their own node numbering.
struct MeshBody {
  std::vector<std::size_t> tetrahedra;  // indices into Tetrahedra
  std::vector<std::int32_t> nodes;      // node indices of the model: corners and mid-edge nodes, ascending
  std::vector<std::int32_t> parts;      // indices of its parts, in the order of the model
  std::unordered_map<std::int32_t, std::int32_t> local;  // maps a node of the model to its index in `nodes`
  std::vector<char> is_corner;                           // for each of its nodes
  std::vector<Triangle> surface;                         // outward, in node indices of the model
  std::vector<Triangle> surface_keys;                    // the same with ascending nodes, sorted
  bool quadratic = false;                                // ten-node elements

  bool HasSurface(const Triangle& triangle) const;
  // Whether the nodes of a triangle of the surface are counter-clockwise seen from outside.
  bool IsOutward(const Triangle& triangle) const;
  bool HasCorner(std::int32_t node) const {
    const auto found = local.find(node);
    return found != local.end() && is_corner[static_cast<std::size_t>(found->second)];
  }
};

// The bodies in the order of their first tetrahedra.
std::vector<MeshBody> MakeBodies(const Tetrahedra& tetrahedra);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_BODIES_H_
