// Any bytes as a FEBio model; the first byte selects the options. The result is a scene whose files a server would
// accept, or problems.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "client/import/febio_import.h"
#include "core/base/check.h"
#include "core/geometry/mesh_checks.h"
#include "core/geometry/mesh_io.h"
#include "proto/rules/field_rules.h"

namespace fascicle {
namespace {

void CheckMeshFile(const v1::Body& body, const client::ImportedScene& imported) {
  for (const client::ImportedFile& file : imported.files) {
    if (file.name != body.mesh().file().path()) continue;
    Problems problems;
    const std::optional<TetMesh> mesh = ReadMesh({file.name, file.bytes, {}}, problems);
    FASCICLE_CHECK(mesh.has_value(), "the mesh can be read");
    return;
  }
  FASCICLE_CHECK(false, "the mesh is there");
}

void ImportAnything(std::string_view data) {
  constexpr std::string_view kUnits[] = {"", "SI", "mm-N-MPa", "um-nN-s"};
  if (data.empty()) return;
  const auto choice = static_cast<unsigned char>(data[0]);
  client::FebioOptions options;
  options.split_hexahedra = (choice & 1) != 0;
  options.accept_loss = (choice & 8) != 0;
  options.units = kUnits[(choice >> 1) % std::size(kUnits)];
  Problems problems;
  const auto imported = client::ImportFebio(data.substr(1), options, problems);
  FASCICLE_CHECK(imported.has_value() == problems.empty(), "a scene or problems");
  if (!imported) return;
  CheckRules(imported->scene, problems);
  FASCICLE_CHECK(problems.empty(), "the scene obeys the rules");
  for (const v1::Body& body : imported->scene.bodies()) CheckMeshFile(body, *imported);
}

}  // namespace
}  // namespace fascicle

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fascicle::ImportAnything({reinterpret_cast<const char*>(data), size});
  return 0;
}
