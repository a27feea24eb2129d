#ifndef FASCICLE_SERVER_TRANSLATE_BODIES_H_
#define FASCICLE_SERVER_TRANSLATE_BODIES_H_

#include "core/base/problems.h"
#include "core/scene/scene.h"
#include "server/translate/body_source.h"

namespace fascicle::server {

// A body, and whether what ties its parts together (mesh, regions, supports, loads) is there for CheckScene to look at.
struct TranslatedBody {
  Body body;
  bool complete = false;
};

// A body with the shape that the method asks for.
TranslatedBody TranslateBody(const BodySource& source, Method method, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_BODIES_H_
