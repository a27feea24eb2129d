#include <set>
#include <string>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

constexpr std::size_t kMostContacts = 100;

void CheckContact(const Scene& scene, const Contact& contact, const std::string& path, Problems& problems) {
  if (contact.friction != 0) {
    problems.Add(JoinPath(path, "friction"), "friction between bodies is not supported yet", "omit it");
  }
  if (contact.lasting) problems.Add(JoinPath(path, "lasting"), "lasting contact is not supported yet", "omit it");
  std::set<std::int32_t> named;
  for (std::size_t k = 0; k < contact.bodies.size(); ++k) {
    const std::string where = JoinPath(path, IndexPath("bodies", k));
    const std::int32_t body = contact.bodies[k];
    if (body < 0 || body >= static_cast<std::int32_t>(scene.bodies.size())) {
      problems.Add(where, "is no body of the scene");
    } else if (!named.insert(body).second) {
      problems.Add(where, "names the body `" + scene.bodies[body].name + "` more than once",
                   "a body does not touch itself: name each body once");
    }
  }
  if (contact.bodies.size() == 1 || (contact.bodies.empty() && scene.bodies.size() == 1)) {
    problems.Add(JoinPath(path, "bodies"), "a contact needs at least two bodies",
                 "name another body, or omit the contact");
  }
}

}  // namespace

void CheckContacts(const Scene& scene, Problems& problems) {
  if (!scene.contacts.empty() && !scene.bodies.empty() && scene.method != Method::kEulerian) {
    problems.Add("contacts", "only the eulerian method supports contacts between bodies",
                 "omit them, or use the eulerian method");
    return;
  }
  if (scene.contacts.size() > kMostContacts) {
    problems.Add("contacts",
                 std::to_string(scene.contacts.size()) + " are too many; at most " + std::to_string(kMostContacts),
                 "name more bodies in each, or none for all bodies");
    return;
  }
  for (std::size_t k = 0; k < scene.contacts.size(); ++k) {
    CheckContact(scene, scene.contacts[k], IndexPath("contacts", k), problems);
  }
}

}  // namespace fascicle::scene_checks
