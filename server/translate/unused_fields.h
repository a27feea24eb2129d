#ifndef FASCICLE_SERVER_TRANSLATE_UNUSED_FIELDS_H_
#define FASCICLE_SERVER_TRANSLATE_UNUSED_FIELDS_H_

#include <string>
#include <vector>

#include "core/scene/body.h"
#include "fascicle/v1/scene.pb.h"

namespace fascicle::server {

// Adds a note to a body for each field that is given, is not zero, and has no effect in the scene's stepping. Notes on
// fields of the method are added to the first body. `scene` is as it was sent: defaults are not given.
void AddUnusedFieldNotes(const v1::Scene& scene, std::vector<Body>& bodies);
// The same for fields of the skeleton, and for those of the method if there are no bodies.
void AddUnusedSkeletonNotes(const v1::Scene& scene, std::vector<std::string>& notes);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_UNUSED_FIELDS_H_
