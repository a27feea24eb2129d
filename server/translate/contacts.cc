#include "server/translate/contacts.h"

#include "server/translate/values.h"

namespace fascicle::server {

std::vector<Contact> TranslateContacts(const v1::Scene& scene, const Names& body_names, Problems& problems) {
  std::vector<Contact> contacts;
  for (int i = 0; i < scene.contacts_size(); ++i) {
    const v1::Contact& wire = scene.contacts(i);
    const std::string path = IndexPath("contacts", static_cast<std::size_t>(i));
    Contact& contact = contacts.emplace_back();
    for (int k = 0; k < wire.bodies_size(); ++k) {
      const std::string where = JoinPath(path, IndexPath("bodies", static_cast<std::size_t>(k)));
      const auto body = body_names.Find(wire.bodies(k), where, problems);
      if (body) contact.bodies.push_back(static_cast<std::int32_t>(*body));
    }
    if (ObeysRules(wire)) contact.friction = wire.friction();
    contact.lasting = wire.lasting();
  }
  return contacts;
}

}  // namespace fascicle::server
