#ifndef FASCICLE_SERVER_TRANSLATE_SUPPORTS_AND_LOADS_H_
#define FASCICLE_SERVER_TRANSLATE_SUPPORTS_AND_LOADS_H_

#include <array>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/scene/scene.h"
#include "fascicle/v1/scene.pb.h"
#include "server/translate/names.h"
#include "server/translate/skeleton.h"

namespace fascicle::server {

// The constraints and loads of a body. Entries with a problem may be missing from the result.
std::vector<Constraint> TranslateConstraints(const v1::Body& body, const std::string& body_path, const Names& regions,
                                             const TranslatedSkeleton& skeleton, Problems& problems);
// A motion of what is held along some axes.
//   metres  in the unit of points on axes of rotation
Motion TranslateMotion(const v1::Motion& motion, const std::array<bool, 3>& axes, double metres,
                       const std::string& path, Problems& problems);
std::vector<Load> TranslateLoads(const v1::Body& body, const std::string& body_path, const Names& regions,
                                 Problems& problems);
// Sets the other ends of the bodies' line springs, once all bodies are known.
void FindEndsOfLineSprings(const v1::Scene& scene, const Names& body_names, std::vector<Body>& bodies,
                           Problems& problems);
Gravity TranslateGravity(const v1::Scene& scene, Problems& problems);
std::vector<Floor> TranslateFloors(const v1::Scene& scene, Problems& problems);
std::vector<PlaneForceField> TranslatePlaneForceFields(const v1::Scene& scene, Problems& problems);

}  // namespace fascicle::server

#endif  // FASCICLE_SERVER_TRANSLATE_SUPPORTS_AND_LOADS_H_
