#ifndef FASCICLE_CORE_EULERIAN_SCENE_BODY_H_
#define FASCICLE_CORE_EULERIAN_SCENE_BODY_H_

#include <cstdint>
#include <span>
#include <string>

#include "core/eulerian/body.h"
#include "core/scene/scene.h"

namespace fascicle {

// The grid of a body of a scene: nodes at multiples of the cell size, around the room that the scene gives or the
// margin around the body at rest.
EulerianGrid GridOf(const EulerianMethod& method, const TriangleMesh& surface);

// The solid that a body of a scene is, with its supports, loads and fibres.
//   Where volumes are preserved, the law keeps no more of its bulk modulus than twice its shear modulus: pressure does
//   the rest, and waves of pressure, which would shorten the step, are not there.
EulerianBody MakeEulerianBody(const Scene& scene, const Body& body, ThreadTeam& team);

// What makes bodies unfit for their grids: surfaces that bound no solid, grids of more cells than `max_cells` together,
// rooms that bodies are not in, supports that hold no node. Adds to `problems`, each with its path.
//   sources  paths of what the surface of each body was made of, such as `bodies[0].mesh.box`
void CheckEulerianBodies(const Scene& scene, std::span<const std::string> sources, std::int64_t max_cells,
                         Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_SCENE_BODY_H_
