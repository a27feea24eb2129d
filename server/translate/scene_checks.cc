#include "server/translate/scene_checks.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

namespace fascicle::server {
namespace {

constexpr std::string_view kOnlyBody = "bodies[0]";

// Adds a problem of a scene with one body as a problem of body number `index`.
void AddRenumbered(const Problem& problem, std::size_t index, Problems& problems) {
  std::string path = problem.path;
  if (path.starts_with(kOnlyBody)) path.replace(0, kOnlyBody.size(), IndexPath("bodies", index));
  const Problem renumbered = {path, problem.message, problem.hint};
  if (path.starts_with("rigid_bodies[") || path.starts_with("contacts[")) return;  // of those that touch this body
  const auto& known = problems.kept();
  if (std::find(known.begin(), known.end(), renumbered) != known.end()) return;
  problems.Add(renumbered.path, renumbered.message, renumbered.hint);
}

}  // namespace

void CheckEachBody(Scene scene, const std::vector<bool>& complete, Problems& problems) {
  std::vector<Body> bodies = std::exchange(scene.bodies, {});
  const std::vector<RigidBody> rigid_bodies = std::exchange(scene.rigid_bodies, {});
  const std::vector<Contact> contacts = std::exchange(scene.contacts, {});
  // Problems of times and output have been reported.
  scene.output = {};
  scene.duration = scene.output.frame_interval = 1;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!complete[i]) continue;
    scene.bodies.clear();
    scene.bodies.push_back(std::move(bodies[i]));
    // What touches the body may take the place of a support.
    scene.rigid_bodies.clear();
    for (const RigidBody& rigid : rigid_bodies) {
      if (Touches(rigid, i)) scene.rigid_bodies.emplace_back(rigid).bodies.clear();
    }
    scene.contacts.assign(
        std::any_of(contacts.begin(), contacts.end(), [&](const Contact& contact) { return Touches(contact, i); }) ? 1
                                                                                                                   : 0,
        Contact());
    Problems own;
    CheckScene(scene, own);
    for (const Problem& problem : own.kept()) AddRenumbered(problem, i, problems);
  }
}

}  // namespace fascicle::server
