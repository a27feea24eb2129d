#ifndef FASCICLE_SERVER_TRANSLATE_METHODS_H_
#define FASCICLE_SERVER_TRANSLATE_METHODS_H_

#include "core/base/problems.h"
#include "core/scene/method.h"
#include "fascicle/v1/scene.pb.h"

namespace fascicle::server {

// Times that the elements of a scene are divided; 0 if the scene's value is invalid.
int RefinementsOf(const v1::Scene& scene);

// The settings of each method for a scene (defaults filled in). Neutral settings replace invalid ones, and those of
// methods that the scene does not use.
TetMethod TranslateTetMethod(const v1::Scene& scene);
VoxelMethod TranslateVoxelMethod(const v1::Scene& scene);
EulerianMethod TranslateEulerianMethod(const v1::Scene& scene, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_METHODS_H_
