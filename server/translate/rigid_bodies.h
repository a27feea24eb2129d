#ifndef FASCICLE_SERVER_TRANSLATE_RIGID_BODIES_H_
#define FASCICLE_SERVER_TRANSLATE_RIGID_BODIES_H_

#include <stop_token>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/scene/scene.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/names.h"
#include "server/translate/translate.h"

namespace fascicle::server {

struct RigidBodySources {
  const AssetReader& assets;
  const std::stop_token& stop;
};

// The rigid bodies of a scene. Surfaces are closed and turned outward; what was done to them is added to `notes`.
//   bodies  the names of the scene's bodies
std::vector<RigidBody> TranslateRigidBodies(const v1::Scene& scene, const RigidBodySources& sources,
                                            const Names& bodies, std::vector<std::string>& notes, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_RIGID_BODIES_H_
