#ifndef FASCICLE_CORE_SCENE_SCENE_H_
#define FASCICLE_CORE_SCENE_SCENE_H_

#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/scene/acting.h"
#include "core/scene/body.h"
#include "core/scene/fields.h"
#include "core/scene/method.h"
#include "core/scene/output.h"

namespace fascicle {

// What is simulated, in SI and with everything resolved: the messages of scene.proto one for one, see there for the
// meaning. Built by the server's translation or by hand, then checked by CheckScene and never changed.
struct Scene {
  std::string name;
  std::vector<Body> bodies;  // all of the method's shape
  Gravity gravity;
  std::vector<Floor> floors;
  Method method = Method::kTet;
  TetMethod tet;
  VoxelMethod voxel;
  EulerianMethod eulerian;
  std::vector<Squeeze> squeezes;  // of the eulerian method
  double duration = 0;            // [s]
  Output output;
};
template <>
inline constexpr auto kFieldNames<Scene> = FieldNames("name", "bodies", "gravity", "floors", "", "tet", "voxel",
                                                      "eulerian", "squeezes", "duration", "output");

// Checks what concerns more than one field: constraints that contradict each other in a node, loads on regions without
// surface, fibres missing for a law that needs them, activation outside [0, 1], bodies without mass, bodies that start
// in a floor, frame counts, a whole body free to fly away under load (not a problem when gravity or loads are absent).
// One check per file in this room.
void CheckScene(const Scene& scene, Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_SCENE_H_
