#ifndef FASCICLE_CORE_SCENE_CURVES_H_
#define FASCICLE_CORE_SCENE_CURVES_H_

#include <functional>
#include <string>

#include "core/scene/scene.h"

namespace fascicle {

// Calls visit(curve, path) for every curve of a scene, with its field path, such as `bodies[0].loads[1].scale`.
void VisitCurves(const Scene& scene, const std::function<void(const Curve& curve, const std::string& path)>& visit);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_CURVES_H_
