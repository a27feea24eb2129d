#ifndef FASCICLE_CORE_SCENE_CHECKS_H_
#define FASCICLE_CORE_SCENE_CHECKS_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/scene/scene.h"

// The checks that CheckScene runs, one to a file. Each adds what it finds to `problems` and leaves the rest alone.
namespace fascicle::scene_checks {

// At least one body; each with elements, a positive density and a name of its own.
void CheckBodies(const Scene& scene, Problems& problems);
// Materials of the parts of a body: one for each element, of those that there are.
void CheckMaterials(const Scene& scene, Problems& problems);
// Activations of the parts likewise, and what each tetrahedron makes of its own: within [0, 1].
void CheckActivations(const Scene& scene, Problems& problems);
// Initial displacements: one for each node, finite.
void CheckInitialDisplacement(const Scene& scene, Problems& problems);
// Fibre directions where a law needs them: one for each tetrahedron, finite and of unit length.
void CheckFibres(const Scene& scene, Problems& problems);
// Curves: as many values as times, times increasing, all finite; activations within [0, 1].
void CheckCurves(const Scene& scene, Problems& problems);
// Constraints that name a region of the body and do not ask two things of one node.
void CheckConstraints(const Scene& scene, Problems& problems);
// Loads on regions that exist, have nodes, and have surface where the load needs one.
void CheckLoads(const Scene& scene, Problems& problems);
// A load or gravity that nothing, not even a floor, holds against: the body would fly away.
void CheckSupports(const Scene& scene, Problems& problems);
// Floors with a unit normal, that no body starts in.
void CheckFloors(const Scene& scene, Problems& problems);
// Steppings with the precision that they need.
void CheckMethod(const Scene& scene, Problems& problems);
// What the voxel method has no answer for: other laws than its two, fibres, activation, floors, damping that is not
// proportional to mass, single axes held across the axes of an image.
void CheckVoxels(const Scene& scene, Problems& problems);
// What the eulerian method has no answer for: parts of bodies, tags of supports, single axes, floors, damping that is
// not proportional to mass; and what no other method has: plasticity, squeezes.
void CheckEulerian(const Scene& scene, Problems& problems);
// Probes that follow a node that exists; the number of frames; duration.
void CheckOutput(const Scene& scene, Problems& problems);

// `parts` is empty or has, for each element, 0 or one of the numbers of `others`, counted from 1.
void CheckPartNumbers(const std::vector<std::int32_t>& parts, std::size_t elements, std::size_t others,
                      const std::string& path, Problems& problems);

}  // namespace fascicle::scene_checks

#endif  // FASCICLE_CORE_SCENE_CHECKS_H_
