#ifndef FASCICLE_CLIENT_EXODUS_EXODUS_READER_H_
#define FASCICLE_CLIENT_EXODUS_EXODUS_READER_H_

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "core/base/problems.h"
#include "core/geometry/mesh_io.h"

namespace fascicle::client {

// Whether a file's extension is that of Exodus II: .e, .exo, .ex2, .exii, .g or .gen, in any case.
bool IsExodusName(const std::string& name);

// Reads an Exodus II mesh. Element blocks, side sets and node sets become physical tags, counted from 1 in this order,
// with their names. Displacements of the file are not applied. Hexahedra, wedges and pyramids are split into tetrahedra
// if `split_solids`, and else kept if there are hexahedra only, or refused. Adds to `problems` (with empty paths) what
// is wrong, and returns nothing then. Throws Stopped after a stop request, which is checked after VTK has read the
// file.
std::optional<TetMesh> ReadExodus(const std::filesystem::path& path, bool split_solids, Problems& problems,
                                  const std::stop_token& stop, MeshRemarks& remarks);

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_EXODUS_EXODUS_READER_H_
