#ifndef FASCICLE_SERVER_TRANSLATE_CONTACTS_H_
#define FASCICLE_SERVER_TRANSLATE_CONTACTS_H_

#include <vector>

#include "core/base/problems.h"
#include "core/scene/contact.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/names.h"

namespace fascicle::server {

// The scene's `contacts`; names of bodies that do not exist are problems.
std::vector<Contact> TranslateContacts(const v1::Scene& scene, const Names& body_names, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_CONTACTS_H_
