#include <cmath>
#include <set>
#include <string>

#include "core/scene/checks.h"

namespace fascicle::scene_checks {
namespace {

constexpr std::size_t kMostContacts = 100;

void CheckContact(const Scene& scene, const Contact& contact, const std::string& path, Problems& problems) {
  if (!(contact.friction >= 0 && std::isfinite(contact.friction))) {
    problems.Add(JoinPath(path, "friction"), "must be a finite number of at least 0");
  }
  if (contact.lasting && contact.friction > 0) {
    problems.Add(JoinPath(path, "friction"), "a lasting contact slides freely", "omit one of lasting and friction");
  }
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
  if (scene.method != Method::kTet) return;
  if (contact.friction > 0) {
    problems.Add(JoinPath(path, "friction"), "the tet method has no friction between bodies", "omit it");
  }
  if (contact.lasting) {
    problems.Add(JoinPath(path, "lasting"), "the tet method has no lasting contact", "omit it");
  }
}

}  // namespace

void CheckContacts(const Scene& scene, Problems& problems) {
  if (!scene.contacts.empty() && scene.method == Method::kVoxel) {
    problems.Add("contacts", "the voxel method does not support contacts", "omit them, or use another method");
    return;
  }
  if (scene.contacts.size() > kMostContacts) {
    problems.Add("contacts",
                 std::to_string(scene.contacts.size()) + " are too many; at most " + std::to_string(kMostContacts),
                 "name more bodies in each, or none for all bodies");
    return;
  }
  for (std::size_t k = 0; k < scene.contacts.size(); ++k) {
    const std::string path = IndexPath("contacts", k);
    const std::size_t before = problems.count();
    CheckContact(scene, scene.contacts[k], path, problems);
    if (problems.count() == before) CheckOverlaps(scene, scene.contacts[k], path, problems);
  }
}

}  // namespace fascicle::scene_checks
