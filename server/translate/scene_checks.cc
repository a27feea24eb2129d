#include "server/translate/scene_checks.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

namespace fascicle::server {
namespace {

constexpr std::string_view kOnlyBody = "bodies[0]";

// What holds for the scene of one body, said of body number `index`.
void AddRenumbered(const Problem& problem, std::size_t index, Problems& problems) {
  std::string path = problem.path;
  if (path.starts_with(kOnlyBody)) path.replace(0, kOnlyBody.size(), IndexPath("bodies", index));
  const Problem renumbered = {path, problem.message, problem.hint};
  const auto& known = problems.kept();
  if (std::find(known.begin(), known.end(), renumbered) != known.end()) return;
  problems.Add(renumbered.path, renumbered.message, renumbered.hint);
}

}  // namespace

void CheckEachBody(Scene scene, const std::vector<bool>& complete, Problems& problems) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (!complete[i]) continue;
    Scene alone;
    alone.method = scene.method;
    alone.tet = scene.tet;
    alone.voxel = scene.voxel;
    alone.eulerian = scene.eulerian;
    alone.squeezes = scene.squeezes;
    alone.gravity = scene.gravity;
    alone.floors = scene.floors;
    alone.duration = alone.output.frame_interval = 1;  // what is wrong with them has been said
    alone.bodies.push_back(std::move(scene.bodies[i]));
    Problems own;
    CheckScene(alone, own);
    for (const Problem& problem : own.kept()) AddRenumbered(problem, i, problems);
  }
}

}  // namespace fascicle::server
