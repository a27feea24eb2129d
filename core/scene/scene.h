#ifndef FASCICLE_CORE_SCENE_SCENE_H_
#define FASCICLE_CORE_SCENE_SCENE_H_

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/problems.h"
#include "core/scene/acting.h"
#include "core/scene/body.h"
#include "core/scene/contact.h"
#include "core/scene/driven_skeleton.h"
#include "core/scene/fields.h"
#include "core/scene/method.h"
#include "core/scene/output.h"
#include "core/scene/rigid_body.h"

namespace fascicle {

// How a scene of the tet method begins.
struct Start {
  bool equilibrium = false;  // solved for time 0
  // Whether initial displacements and velocities are those of another run's frame.
  bool frame = false;
};
template <>
inline constexpr auto kFieldNames<Start> = FieldNames("equilibrium", "frame");

// The definition of a simulation, in SI units with all references resolved. Its structs correspond to the messages of
// scene.proto, which explains their fields. Built by the server's translation or by hand, checked by CheckScene, then
// constant.
struct Scene {
  std::string name;
  std::vector<Body> bodies;  // all of the method's shape
  Gravity gravity;
  std::vector<Floor> floors;
  Method method = Method::kTet;
  TetMethod tet;
  VoxelMethod voxel;
  EulerianMethod eulerian;
  std::vector<PlaneForceField> squeezes;  // for the eulerian method
  double duration = 0;                    // [s]
  Output output;
  Start start;
  std::vector<RigidBody> rigid_bodies;
  std::vector<Contact> contacts;
  std::optional<DrivenSkeleton> skeleton;
};
template <>
inline constexpr auto kFieldNames<Scene> = FieldNames("name", "bodies", "gravity", "floors", "", "tet", "voxel",
                                                      "eulerian", "squeezes", "duration", "output", "start",
                                                      "rigid_bodies", "contacts", "skeleton");

// Checks relations between fields: contradictory constraints at a node, loads on regions without surface, missing
// fibres, activation outside [0, 1], bodies without mass, bodies that start inside of a floor or a rigid body, number
// of frames, a skeleton's motion and activations, and bodies that loads would accelerate indefinitely (without loads
// and gravity, free bodies are allowed). Each file of this room has one check. Throws Stopped between two checks after
// a stop request.
void CheckScene(const Scene& scene, Problems& problems, const std::stop_token& stop = {});

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_SCENE_H_
