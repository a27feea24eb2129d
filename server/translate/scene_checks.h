#ifndef FASCICLE_SERVER_TRANSLATE_SCENE_CHECKS_H_
#define FASCICLE_SERVER_TRANSLATE_SCENE_CHECKS_H_

#include <vector>

#include "core/base/problems.h"
#include "core/scene/scene.h"

namespace fascicle::server {

// CheckScene for each `complete` body as if it were alone, for a scene in which something is wrong already: a user
// sees what is wrong with the second body though the first has no mesh. The scene is used up.
void CheckEachBody(Scene scene, const std::vector<bool>& complete, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_SCENE_CHECKS_H_
