#ifndef FASCICLE_SERVER_TRANSLATE_START_H_
#define FASCICLE_SERVER_TRANSLATE_START_H_

#include "core/base/problems.h"
#include "core/scene/scene.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/translate.h"

namespace fascicle::server {

// The scene's `start`: for a frame, sets the initial displacements and velocities of the bodies of `scene`, which have
// been translated, and adds a note to the first one. Anything in which the frame's bodies differ from them is a
// problem.
void TranslateStart(const v1::Scene& wire, const AssetReader& assets, Scene& scene, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_START_H_
