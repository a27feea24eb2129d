#ifndef FASCICLE_SERVER_TRANSLATE_OUTPUTS_H_
#define FASCICLE_SERVER_TRANSLATE_OUTPUTS_H_

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/scene/scene.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/names.h"

namespace fascicle::server {

// The output settings. `bodies` are those of the scene; a body without nodes is unknown and ignored. Adds a note to a
// body for each probe outside of it.
Output TranslateOutput(const v1::Scene& scene, Method method, ElementOrder order, std::vector<Body>& bodies,
                       const Names& body_names, std::int64_t max_frame_bytes, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_OUTPUTS_H_
