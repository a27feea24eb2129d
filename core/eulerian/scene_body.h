#ifndef FASCICLE_CORE_EULERIAN_SCENE_BODY_H_
#define FASCICLE_CORE_EULERIAN_SCENE_BODY_H_

#include <cstdint>
#include <span>
#include <string>

#include "core/eulerian/body.h"
#include "core/scene/scene.h"

namespace fascicle {

// The grid of a body of a scene: nodes at multiples of the cell size, covering the scene's `lowest` to `highest`, or
// the body at rest plus its margin.
EulerianGrid GridOf(const EulerianMethod& method, const TriangleMesh& surface);

// The solid of a scene's body, with its supports, loads and fibres. If volumes are preserved, the law keeps at most
// twice its shear modulus as bulk modulus: pressure preserves the volumes, and the step is not limited by pressure
// waves.
EulerianBody MakeEulerianBody(const Scene& scene, const Body& body, ThreadTeam& team);

// Reports bodies that do not fit their grids: surfaces that bound no solid, grids with more than `max_cells` cells in
// total, bodies outside of the given grid, supports without nodes. Each problem has its path.
//   sources  paths of the sources of the bodies' surfaces, such as `bodies[0].mesh.box`
void CheckEulerianBodies(const Scene& scene, std::span<const std::string> sources, std::int64_t max_cells,
                         Problems& problems);

}  // namespace fascicle

#endif  // FASCICLE_CORE_EULERIAN_SCENE_BODY_H_
