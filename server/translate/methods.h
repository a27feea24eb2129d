#ifndef FASCICLE_SERVER_TRANSLATE_METHODS_H_
#define FASCICLE_SERVER_TRANSLATE_METHODS_H_

#include "core/base/problems.h"
#include "core/scene/method.h"
#include "fascicle/v1/scene.pb.h"

namespace fascicle::server {

// How a scene (defaults filled in) is stepped, method by method. A neutral method stands for a wrong one, and for one
// that the scene does not name.
TetMethod TranslateTetMethod(const v1::Scene& scene);
VoxelMethod TranslateVoxelMethod(const v1::Scene& scene);
EulerianMethod TranslateEulerianMethod(const v1::Scene& scene, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_METHODS_H_
