#ifndef FASCICLE_CLIENT_CLI_CONVERT_MESH_H_
#define FASCICLE_CLIENT_CLI_CONVERT_MESH_H_

#include <stop_token>
#include <string>

#include "client/cli/command.h"

namespace fascicle::client {

// A volume mesh of another program, to be written in Gmsh's format.
struct Conversion {
  std::string input;
  std::string out;
  std::string unit;  // m, cm or mm: of both files
  bool split_hexahedra = false;
};

// `fascicle mesh --convert`: reads the mesh with its named sets, checks it as a scene would, writes it with the sets as
// physical tags, and prints what it has. Throws CommandError with all problems, and Stopped after a stop request.
void ConvertMesh(const Conversion& conversion, const Context& context, const std::stop_token& stop);

// The extensions of meshes that can be converted, for messages.
std::string ConvertibleExtensions();

}  // namespace fascicle::client

#endif  // FASCICLE_CLIENT_CLI_CONVERT_MESH_H_
