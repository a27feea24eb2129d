#ifndef FASCICLE_CLIENT_IMPORT_FEBIO_MESH_H_
#define FASCICLE_CLIENT_IMPORT_FEBIO_MESH_H_

#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "core/base/problems.h"
#include "core/geometry/mesh_io.h"

namespace fascicle::client {

// Reads the mesh of a FEBio model and nothing else of it. Parts, element sets, surfaces and node sets become physical
// tags, counted from 1 in this order, with their names. Hexahedra, wedges and pyramids are split into tetrahedra if
// `split_solids`, and else kept if there are hexahedra only, or refused. `name` is that of the file in messages. Adds
// to `problems` what is wrong, and returns nothing then. Throws Stopped after a stop request.
std::optional<TetMesh> ReadFebioMesh(const std::string& name, std::string_view bytes, bool split_solids,
                                     Problems& problems, const std::stop_token& stop, MeshRemarks& remarks);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_IMPORT_FEBIO_MESH_H_
