#ifndef FASCICLE_CORE_SCENE_FREE_MOTIONS_H_
#define FASCICLE_CORE_SCENE_FREE_MOTIONS_H_

#include <string>
#include <vector>

#include "core/scene/body.h"

namespace fascicle {

// A part of a tetrahedral body that its supports leave free to move as a rigid body.
struct FreePart {
  std::size_t tetrahedra = 0;  // of the part
  std::size_t parts = 1;       // of the body
  Vec3 place = Vec3::Zero();   // a node of the part [m]
  // Such as "moves along x and y, turns about z", "turns about the point [0, 0, 0] m", or "turns about the line through
  // [0, 0, 0] m along [1, 0, 0]".
  std::string motions;
};

// The parts (elements connected by nodes) of a body with a TetShape that have infinitesimal rigid motions under which
// no prescribed component of a node moves. Prescribed are the components of its constraints, whatever their motion, and
// those of its springs.
std::vector<FreePart> FindFreeParts(const Body& body);

}  // namespace fascicle

#endif  // FASCICLE_CORE_SCENE_FREE_MOTIONS_H_
