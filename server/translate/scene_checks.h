#ifndef FASCICLE_SERVER_TRANSLATE_SCENE_CHECKS_H_
#define FASCICLE_SERVER_TRANSLATE_SCENE_CHECKS_H_

#include <vector>

#include "core/base/problems.h"
#include "core/scene/scene.h"

namespace fascicle::server {

// Runs CheckScene for each `complete` body by itself, for a scene that has problems already. So a user sees the
// problems of the second body even if the first one has no mesh. Consumes the scene.
void CheckEachBody(Scene scene, const std::vector<bool>& complete, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_SCENE_CHECKS_H_
