#include "server/translate/number_files.h"
#include "server/translate/parts.h"
#include "server/translate/values.h"

namespace fascicle::server {

std::vector<Vec3> TranslateInitialDisplacement(const BodySource& source, std::optional<std::size_t> nodes,
                                               Problems& problems) {
  std::vector<Vec3> displacement;
  if (!source.wire.has_initial_displacement()) return displacement;
  const NumberFile file = {"nodes", nodes, 3};
  const std::vector<double> values = ReadNumberFile(
      source.wire.initial_displacement(), file, JoinPath(source.path, "initial_displacement"), source.assets, problems);
  const double metres = MetresIn(source.wire.unit());
  for (std::size_t i = 0; i < values.size(); i += 3) {
    displacement.push_back(metres * Vec3(values[i], values[i + 1], values[i + 2]));
  }
  return displacement;
}

}  // namespace fascicle::server
