#include "server/translate/number_files.h"
#include "server/translate/parts.h"
#include "server/translate/values.h"

namespace fascicle::server {

void TranslateInitialDisplacement(const v1::Body& body, const std::string& body_path, const TranslatedMesh* mesh,
                                  const AssetReader& assets, Body& result, Problems& problems) {
  if (!body.has_initial_displacement()) return;
  NumberFile file = {"nodes", std::nullopt, 3};
  if (mesh != nullptr) file.lines = mesh->nodes().size();
  const std::vector<double> values =
      ReadNumberFile(body.initial_displacement(), file, JoinPath(body_path, "initial_displacement"), assets, problems);
  const double metres = MetresIn(body.unit());
  for (std::size_t i = 0; i < values.size(); i += 3) {
    result.initial_displacement.push_back(metres * Vec3(values[i], values[i + 1], values[i + 2]));
  }
}

}  // namespace fascicle::server
