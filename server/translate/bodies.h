#ifndef FASCICLE_SERVER_TRANSLATE_BODIES_H_
#define FASCICLE_SERVER_TRANSLATE_BODIES_H_

#include "core/base/problems.h"
#include "core/scene/scene.h"
#include "server/translate/body_source.h"

namespace fascicle::server {

// A body, and whether it is complete enough (mesh, regions, supports, loads) for CheckScene.
struct TranslatedBody {
  Body body;
  bool complete = false;
};

// A body with the shape of the method.
TranslatedBody TranslateBody(const BodySource& source, Method method, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_BODIES_H_
