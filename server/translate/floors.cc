#include "server/translate/supports_and_loads.h"
#include "server/translate/values.h"

namespace fascicle::server {

std::vector<Floor> TranslateFloors(const v1::Scene& scene, Problems& problems) {
  std::vector<Floor> floors;
  Names names("floor");
  for (int i = 0; i < scene.floors_size(); ++i) {
    const v1::Floor& floor = scene.floors(i);
    const std::string path = IndexPath("floors", static_cast<std::size_t>(i));
    names.Add(floor.name(), JoinPath(path, "name"), problems);
    floors.push_back(
        {floor.name(), ToVec3(floor.point()), ToDirection(floor.normal(), JoinPath(path, "normal"), problems)});
  }
  return floors;
}

}  // namespace fascicle::server
